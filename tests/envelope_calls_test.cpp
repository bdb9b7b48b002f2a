// Envelopes by their calls: what is free, what is refused, what is reported, and that nothing is paid when they are
// off.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <sweepgrid/engine/object_table.hpp>
#include <sweepgrid/sap/quantizer.hpp>
#include <sweepgrid/sap/rounding.hpp>

#include "envelope_play.hpp"

namespace sweepgrid::oracle::envelope_calls_test {
namespace {

using Box2 = Box<double, 2>;
using Engine2 = Engine<double, 2>;

Engine2 engine_with(const EnvelopeOptions& options, int threads = 1) {
  Config config;
  config.threads = threads;
  config.parallel_from = 0;
  config.envelope = options;
  return Engine2(config);
}

Box2 at(double x, double y = 0) { return {{x, y}, {x + 1, y + 1}}; }

TEST(Margin, AnUpdateInsideIsFree) {
  Engine2 engine = engine_with({.margin = 0.5});
  const Handle a = engine.insert(1, at(0));
  engine.insert(2, at(3));
  engine.step();
  engine.update(a, at(0.4));
  EXPECT_EQ(engine.box(a), at(0.4));
  EXPECT_TRUE(holds(engine.envelope(a), Box2({-0.5, -0.5}, {1.5, 1.5})));
  EXPECT_TRUE(engine.step().begins.empty());
  EXPECT_EQ(engine.stats().step, StepCounters{});
  engine.update(a, at(0.6));
  EXPECT_TRUE(engine.step().begins.empty());
  EXPECT_EQ(engine.stats().step.updates, 1U);
  engine.update(a, at(1.2));
  EXPECT_EQ(engine.step().begins, (Pairs{{1, 2}}));  // the envelopes touch, the boxes do not
}

TEST(Margin, HysteresisStopsFlicker) {
  for (const bool exact : {false, true}) {
    Engine2 engine = engine_with({.margin = 0.5, .exact = exact});
    const Handle a = engine.insert(1, at(0));
    engine.insert(2, at(1.05));
    std::size_t events = 0;
    for (int step = 0; step < 40; ++step) {
      engine.update(a, at(step % 2 == 0 ? 0 : 0.1));
      const auto& now = engine.step();
      events += now.begins.size() + now.ends.size();
    }
    EXPECT_EQ(events, exact ? 39U : 1U);
    EXPECT_LE(engine.stats().total.updates, 1U);
  }
}

TEST(Margin, AnEnvelopeThatIsMuchTooWideIsMadeAnew) {
  Engine2 engine = engine_with({.margin = 0.5});
  const Handle a = engine.insert(1, {{-100, -100}, {100, 100}});
  engine.insert(2, at(50));
  EXPECT_EQ(engine.step().begins.size(), 1U);
  engine.update(a, at(0));
  EXPECT_EQ(engine.step().ends.size(), 1U);
}

TEST(Margin, AnObjectMayHaveItsOwn) {
  Engine2 engine = engine_with({.margin = 0.5});
  const Handle a = engine.insert(1, at(0), 10);
  const Handle b = engine.insert(2, at(100), 0);
  engine.step();
  engine.update(a, at(9));
  engine.update(b, at(100.1));
  engine.step();
  EXPECT_EQ(engine.stats().step.updates, 1U);
  EXPECT_EQ(engine.envelope(b), at(100.1));
  engine.set_margin(a, 0);
  engine.step();
  EXPECT_EQ(engine.envelope(a), at(9));
  engine.validate();
}

TEST(Margin, FollowsTheDisplacementsOfLate) {
  Engine2 engine = engine_with({.margin = 0.25, .margin_steps = 4});
  const Handle a = engine.insert(1, at(0));
  engine.step();
  EXPECT_EQ(engine.envelope_report().margin, 0.25);
  engine.update(a, at(2));
  engine.step();
  EXPECT_EQ(engine.envelope_report().margin, 8.25);
  engine.update(a, at(3));  // inside, and so nothing is looked at
  engine.step();
  EXPECT_EQ(engine.stats().step.updates, 0U);
}

TEST(Envelope, BadCallsAreRefusedAndChangeNothing) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const EnvelopeOptions& options : {EnvelopeOptions{.margin = -1}, EnvelopeOptions{.margin = infinity},
                                         EnvelopeOptions{.margin_steps = -0.1}, EnvelopeOptions{.margin = std::nan("")},
                                         EnvelopeOptions{.stride = 0}, EnvelopeOptions{.swept = true, .exact = true}}) {
    EXPECT_THROW(static_cast<void>(engine_with(options)), std::invalid_argument);
  }
  Engine2 off;
  const Handle plain = off.insert(1, at(0));
  EXPECT_THROW(off.insert(2, at(0), 1), std::invalid_argument);
  EXPECT_THROW(off.set_margin(plain, 1), std::invalid_argument);
  EXPECT_THROW(off.update(plain, at(0), {1, 0}), std::invalid_argument);
  EXPECT_FALSE(off.contains(2));

  Engine2 engine = engine_with({.margin = 1});
  const Handle a = engine.insert(1, at(0));
  const Handle b = engine.insert(2, at(5));
  EXPECT_THROW(engine.insert(1, at(9)), std::invalid_argument);
  EXPECT_THROW(engine.insert(3, {{1, 0}, {0.9, 1}}), std::invalid_argument);  // would be valid once it is grown
  EXPECT_THROW(engine.insert(3, at(0), -1), std::invalid_argument);
  EXPECT_THROW(engine.set_margin(a, std::nan("")), std::invalid_argument);
  EXPECT_THROW(engine.update(a, at(0), {1, 0}), std::invalid_argument);  // not swept
  EXPECT_THROW(engine.update(a, {{0, 0}, {-0.5, 1}}), std::invalid_argument);
  const std::array handles{a, b};
  const std::array bad{at(1), Box2({0, 0}, {1, std::nan("")})};
  EXPECT_THROW(engine.update(handles, bad), std::invalid_argument);
  EXPECT_EQ(engine.box(a), at(0));
  const std::array<std::uint64_t, 2> keys{7, 8};
  EXPECT_THROW(engine.insert(keys, bad), std::invalid_argument);
  EXPECT_EQ(engine.size(), 2U);
  engine.erase(a);
  EXPECT_THROW(engine.update(a, at(0)), std::invalid_argument);
  EXPECT_THROW(engine.update(handles, std::array{at(0), at(1)}), std::invalid_argument);
  EXPECT_EQ(engine.box(b), at(5));
  const Handle again = engine.insert(1, at(5));
  EXPECT_EQ(engine.step().begins, (Pairs{{1, 2}}));
  engine.erase(again);
  EXPECT_EQ(engine.step().ends, (Pairs{{1, 2}}));
  engine.validate();
}

TEST(Stride, QueriesEveryKthStep) {
  Engine2 engine = engine_with({.stride = 3});
  const Handle a = engine.insert(1, at(0));
  engine.insert(2, at(5));
  engine.step();
  for (int step = 1; step <= 6; ++step) {
    engine.update(a, at(step <= 3 ? 5 : 0));
    const auto& events = engine.step();
    EXPECT_EQ(events.begins.size(), step == 3 ? 1U : 0U);
    EXPECT_EQ(events.ends.size(), step == 6 ? 1U : 0U);
  }
  EXPECT_EQ(engine.envelope_report().queries, 3U);
  EXPECT_EQ(engine.stats().steps, 7U);
}

TEST(Stride, AViolationIsReportedOrMakesAQuery) {
  for (const OnViolation what : {OnViolation::kReport, OnViolation::kQuery}) {
    for (const int threads : {1, 4}) {
      Engine2 engine = engine_with({.margin = 1, .stride = 4, .on_violation = what}, threads);
      std::vector<Handle> handles;
      for (int i = 0; i < 6000; ++i) handles.push_back(engine.insert(static_cast<std::uint64_t>(i), at(10.0 * i)));
      engine.step();
      for (int i = 0; i < 6000; ++i) engine.update(handles[static_cast<std::size_t>(i)], at(10.0 * i + 0.3));
      engine.step();
      EXPECT_EQ(engine.envelope_report().violations, 0U);
      engine.update(handles[17], at(180));  // where another one is
      engine.update(handles[5999], at(51));
      const auto events = engine.step();
      const EnvelopeReport report = engine.envelope_report();
      if (what == OnViolation::kReport) {
        EXPECT_EQ(report.outside, (std::vector{handles[17], handles[5999]}));
        EXPECT_EQ(report.violations, 2U);
        EXPECT_EQ(report.early, 0U);
        EXPECT_TRUE(events.begins.empty());
        engine.step();
        EXPECT_EQ(engine.envelope_report().violations, 4U);  // they are still there
        EXPECT_EQ(engine.step().begins, (Pairs{{5, 5999}, {17, 18}}));
        EXPECT_TRUE(engine.envelope_report().outside.empty());
      } else {
        EXPECT_TRUE(report.outside.empty());
        EXPECT_EQ(report.early, 1U);
        EXPECT_EQ(report.queries, 2U);
        EXPECT_EQ(events.begins, (Pairs{{5, 5999}, {17, 18}}));
      }
    }
  }
}

TEST(Stride, AMarginOfTwiceTheWayIsNeverLeft) {
  // No object goes farther than 0.5 per step, and three steps lie between two queries.
  for (const EnvelopeOptions& options :
       {EnvelopeOptions{.margin = 3, .stride = 4}, EnvelopeOptions{.margin = 3, .stride = 4, .exact = true}}) {
    Engine2 engine = engine_with(options);
    EngineModel<double, 2> model;
    Random random(3);
    std::vector<std::array<double, 2>> places;
    for (std::uint64_t i = 0; i < 150; ++i) {
      places.push_back({random.below(1000) * 0.03, random.below(1000) * 0.03});
      engine.insert(i, at(places[i][0], places[i][1]));
      model.insert(i, at(places[i][0], places[i][1]));
    }
    for (int step = 0; step < 60; ++step) {
      const auto& events = engine.step();
      const auto& expected = model.step();
      if (options.exact) {
        ASSERT_EQ(difference(expected, events), "");
      }
      ASSERT_TRUE(missed(model.pairs(), engine.pairs()).empty()) << step;
      for (std::uint64_t i = 0; i < 150; ++i) {
        for (double& coordinate : places[i]) coordinate += random.between(-500, 500) * 0.001;
        engine.update(i, at(places[i][0], places[i][1]));
        model.update(i, at(places[i][0], places[i][1]));
      }
    }
    EXPECT_EQ(engine.envelope_report().violations, 0U);
    EXPECT_EQ(engine.envelope_report().queries, 15U);
    EXPECT_LT(engine.stats().total.updates, 15U * 150U);
  }
}

// Boxes of the world far from the origin, in an engine with narrower numbers.
template <class Scalar, class Convert>
void compare_far(const std::vector<std::vector<Box2>>& steps, const Convert& convert, std::size_t& extra) {
  Engine<Scalar, 2> engine;
  EngineModel<double, 2> model;
  for (const auto& boxes : steps) {
    for (std::uint64_t i = 0; i < boxes.size(); ++i) {
      if (engine.contains(i)) {
        engine.update(i, convert(boxes[i]));
        model.update(i, boxes[i]);
      } else {
        engine.insert(i, convert(boxes[i]));
        model.insert(i, boxes[i]);
      }
    }
    engine.step();
    model.step();
    ASSERT_FALSE(model.pairs().empty());
    ASSERT_TRUE(missed(model.pairs(), engine.pairs()).empty());
    extra += missed(engine.pairs(), model.pairs()).size();
  }
}

TEST(Rounding, MissesNothingFarFromTheOrigin) {
  for (const double distance : {0.0, 1e3, 1e5, 1e8, 1e12}) {
    std::mt19937_64 random(9);
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    std::vector<std::vector<Box2>> steps(4);
    for (auto& boxes : steps) {
      for (int i = 0; i < 200; ++i) boxes.push_back(at(distance + 20 * unit(), -distance + 20 * unit()));
    }
    std::size_t extra = 0;
    compare_far<float>(
        steps, [](const Box2& box) { return round_outward<float>(box); }, extra);
    if (distance == 0) {
      EXPECT_LT(extra, 5U);
    }
    const auto fine = Quantizer<std::int32_t, 2>({distance, -distance}, 1e-6);
    extra = 0;
    compare_far<std::int32_t>(steps, fine, extra);
    EXPECT_LT(extra, distance < 1e9 ? 5U : 200U);
    const Box2 world({distance, -distance}, {distance + 21, -distance + 21});
    extra = 0;
    compare_far<std::int16_t>(steps, Quantizer<std::int16_t, 2>::covering(world), extra);
    EXPECT_LT(extra, 200U);
  }
}

TEST(Envelope, CostsNothingWhenOff) {
  // An object is a cache line, as ever.
  EXPECT_EQ((sizeof(ObjectTable<float, 3>::Record)), 64U);
  EXPECT_EQ((sizeof(ObjectTable<float, 2>::Record)), 64U);
  // The same counters as with envelopes that are the boxes.
  const SceneRegime regime{.name = "Uniform", .churn_percent = 5};
  Config config;
  config.threads = 1;
  Engine2 off(config);
  Engine2 on = engine_with({});
  SceneScript<double, 2> first(regime, 3);
  SceneScript<double, 2> second(regime, 3);
  for (int step = 0; step < 20; ++step) {
    queue(off, first.next(), Calls::kByHandle);
    queue(on, second.next(), Calls::kByHandle);
    EXPECT_EQ(off.step(), on.step());
    EXPECT_EQ(off.stats().step, on.stats().step);
    EXPECT_EQ(off.envelope_report().steps, 0U);
  }
}

TEST(Envelope, ReportsTheStagesOfTheFilter) {
  Engine2 engine = engine_with({.margin = 1, .exact = true});
  const Handle a = engine.insert(1, at(0));
  engine.insert(2, at(1.5));
  engine.record_tasks(true);
  EXPECT_TRUE(engine.step().begins.empty());
  EXPECT_EQ(engine.envelope_report().candidates, 1U);
  EXPECT_EQ(engine.stats().pairs, 0U);
  engine.update(a, at(0.6));
  EXPECT_EQ(engine.step().begins.size(), 1U);
  const Stats stats = engine.stats();
  EXPECT_EQ(stats.step.begins, 1U);
  EXPECT_EQ(stats.total.begins, 1U);
  EXPECT_EQ(stats.pairs, 1U);
  EXPECT_EQ(stats.step.updates, 0U);
  ASSERT_EQ(stats.stages.size(), engine.stage_names().size());
  for (std::size_t i = 0; i < stats.stages.size(); ++i) EXPECT_EQ(stats.stages[i].stage, engine.stage_names()[i]);
  for (const TaskRecord& task : engine.tasks()) EXPECT_LT(task.stage, stats.stages.size());
  EXPECT_FALSE(engine.tasks().empty());
}

}  // namespace
}  // namespace sweepgrid::oracle::envelope_calls_test
