// Objects that jump cost themselves: what the others cost is as it is when nobody jumps.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <type_traits>
#include <vector>

#include "envelope_play.hpp"

namespace sweepgrid::oracle::envelope_jump_test {
namespace {

/// What a run cost, in counts.
struct Cost {
  std::size_t candidates = 0;  // the most after a step
  std::uint64_t updates = 0;   // envelopes made anew, for all steps
  std::uint64_t events = 0;    // of the envelopes, begins and ends
  std::uint64_t early = 0;
  std::uint64_t jumps = 0;
};

struct Scene {
  int objects = 500;
  int jumpers = 0;  // of them, each time
  int every = 1;    // steps
  double by = 30;   // widths
};

/// Boxes of width 1 that tremble by a twentieth, a few of them overlapping. Checks pairs beside an engine without
/// envelopes.
template <class Scalar, int Dim>
Cost play_jumps(const EnvelopeOptions& options, const Scene& scene) {
  const double scale = std::is_integral_v<Scalar> ? 1000 : 1;
  const double edge = std::pow(scene.objects / 0.05, 1.0 / Dim);
  EnvelopeOptions scaled = options;
  scaled.margin *= scale;
  Config config;
  config.threads = 1;
  Engine<Scalar, Dim> exact(config);
  config.envelope = scaled;
  Engine<Scalar, Dim> engine(config);

  std::mt19937 random(7);
  std::mt19937 jumps(8);  // its own, so that the others do the same with and without
  const auto unit = [](std::mt19937& source) { return source() * 0x1p-32; };
  std::vector<std::array<double, Dim>> places(static_cast<std::size_t>(scene.objects));
  for (auto& place : places) {
    for (double& coordinate : place) coordinate = edge * unit(random);
  }
  const auto box_of = [&](std::size_t object, int step) {
    Box<Scalar, Dim> box;
    for (int axis = 0; axis < Dim; ++axis) {
      const double shake = axis == 0 ? 0.05 * ((static_cast<int>(object) + step) % 3 - 1) : 0;
      const double at = places[object][static_cast<std::size_t>(axis)] + shake;
      box.min[axis] = static_cast<Scalar>(scale * at);
      box.max[axis] = static_cast<Scalar>(scale * (at + 1));
    }
    return box;
  };
  for (std::size_t i = 0; i < places.size(); ++i) {
    engine.insert(i, box_of(i, 0));
    exact.insert(i, box_of(i, 0));
  }
  engine.step();
  exact.step();

  Cost cost;
  Cost begun;  // when the scene runs
  for (int step = 1; step <= 36; ++step) {
    for (int i = 0; i < (step > 6 && step % scene.every == 0 ? scene.jumpers : 0); ++i) {
      auto& place = places[jumps() % places.size()];
      place[Dim - 1] += (place[Dim - 1] > edge / 2 ? -1 : 1) * scene.by;
      ++cost.jumps;
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
      engine.update(i, box_of(i, step));
      exact.update(i, box_of(i, step));
    }
    engine.step();
    exact.step();
    const Pairs wanted = exact.pairs();
    const Pairs found = engine.pairs();
    const Pairs lost = missed(wanted, found);
    if (options.on_violation == OnViolation::kQuery || options.stride == 1) {
      EXPECT_TRUE(lost.empty()) << step;
    } else {
      EXPECT_TRUE(all_named(lost, engine)) << step;
    }
    if (options.exact) {
      EXPECT_EQ(wanted, found) << step;
    }
    const Stats stats = engine.stats();
    if (step == 6) begun = {0, stats.total.updates, stats.total.begins + stats.total.ends, 0, 0};
    cost.candidates = std::max(cost.candidates, engine.envelope_report().candidates);
    cost.updates = stats.total.updates - begun.updates;
    cost.events = stats.total.begins + stats.total.ends - begun.events;
  }
  cost.early = engine.envelope_report().early;
  engine.validate();
  return cost;
}

template <class Scalar, int Dim>
void compare_jumps(const EnvelopeOptions& options, const char* name) {
  SCOPED_TRACE(name);
  const Cost still = play_jumps<Scalar, Dim>(options, {});
  for (const Scene& scene : {Scene{.jumpers = 1, .every = 32}, Scene{.jumpers = 5, .every = 9},
                             Scene{.jumpers = 5, .every = 9, .by = 1000}, Scene{.jumpers = 2, .every = 2}}) {
    const Cost cost = play_jumps<Scalar, Dim>(options, scene);
    ASSERT_GT(cost.jumps, 0U);
    // An envelope meets fewer than ten others here.
    EXPECT_LE(cost.candidates, 1.1 * still.candidates + 10.0 * scene.jumpers);
    EXPECT_LE(cost.updates, still.updates + 4 * cost.jumps) << scene.jumpers << " jump by " << scene.by;
    EXPECT_LE(cost.events, still.events + 40 * cost.jumps);
    EXPECT_LE(cost.early, still.early + cost.jumps);
  }
}

TEST(Jump, CostsThoseWhoJump) {
  constexpr auto kQuery = OnViolation::kQuery;
  compare_jumps<float, 3>({.margin = 0.05, .margin_steps = 2, .stride = 2, .on_violation = kQuery}, "stride");
  compare_jumps<double, 2>({.margin = 0.05, .margin_steps = 2, .stride = 2, .on_violation = kQuery, .exact = true},
                           "exact");
  compare_jumps<std::int32_t, 2>({.margin = 0.05, .margin_steps = 6, .stride = 4}, "reports");
  compare_jumps<float, 2>({.margin = 0.02, .margin_steps = 1}, "no stride");
  compare_jumps<float, 2>({.margin = 0.2, .stride = 5, .on_violation = kQuery}, "margin");
}

// One that is fast in every step is as wide as margin_steps asks for, and nobody else is.
TEST(Jump, WhoIsAlwaysFastHasAWideEnvelopeOfItsOwn) {
  Config config;
  config.threads = 1;
  config.envelope = EnvelopeOptions{.margin = 0.1, .margin_steps = 2, .stride = 2};
  Engine<double, 2> engine(config);
  const Handle fast = engine.insert(0, {{0, 0}, {1, 1}});
  std::vector<Handle> slow;
  for (int i = 1; i < 200; ++i) {
    slow.push_back(engine.insert(static_cast<std::uint64_t>(i), {{2.0 * i, 5}, {2.0 * i + 1, 6}}));
  }
  for (int step = 0; step < 40; ++step) {
    engine.step();
    if (step >= 6) {
      EXPECT_TRUE(engine.envelope_report().outside.empty()) << step;
    }
    const double x = 30.0 * (step + 1);
    engine.update(fast, {{x, 0}, {x + 1, 1}});
    for (std::size_t i = 0; i < slow.size(); ++i) {
      const double y = 5 + 0.01 * (step % 2);
      const double left = 2.0 * static_cast<double>(i + 1);
      engine.update(slow[i], {{left, y}, {left + 1, y + 1}});
    }
  }
  engine.step();
  EXPECT_GE(engine.envelope(fast).max[0], engine.box(fast).max[0] + 30);
  for (const Handle object : slow) EXPECT_LE(engine.envelope(object).max[1], 6.5);
  EXPECT_LE(engine.stats().pairs, slow.size());
}

// An early query is about those that made it necessary.
TEST(Jump, LeavesTheStrideOfTheOthersAlone) {
  Config config;
  config.threads = 1;
  config.envelope = EnvelopeOptions{.margin = 1, .stride = 4, .on_violation = OnViolation::kQuery};
  Engine<double, 2> engine(config);
  std::vector<Handle> objects;
  const auto at = [](double x) { return Box<double, 2>({x, 0}, {x + 1, 1}); };
  for (int i = 0; i < 50; ++i) objects.push_back(engine.insert(static_cast<std::uint64_t>(i), at(10 * i)));
  constexpr std::array<std::uint64_t, 9> kQueries{1, 1, 2, 2, 3, 3, 4, 5, 6};  // by step
  engine.step();                                                               // a query, and every fourth after it
  for (int step = 1; step <= 8; ++step) {
    for (std::size_t i = 1; i < objects.size(); ++i) {
      engine.update(objects[i], at(10 * static_cast<double>(i) + 0.2 * step));
    }
    if (step % 4 == 2) engine.update(objects[0], at(100.0 * step));
    if (step == 7) engine.insert(1000, at(800));
    engine.step();
    const EnvelopeReport report = engine.envelope_report();
    EXPECT_EQ(report.queries, kQueries[static_cast<std::size_t>(step)]) << step;
    EXPECT_EQ(engine.stats().step.updates, step % 4 == 2 ? 1U : step % 4 == 0 ? 49U : 0U) << step;
  }
}

}  // namespace
}  // namespace sweepgrid::oracle::envelope_jump_test
