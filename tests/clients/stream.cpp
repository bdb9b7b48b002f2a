// Prints digests of the events and counters of generated scenes, and of what boxes are rounded to: the same on every
// machine, for every compiler and all flags. Every step's pairs are compared with those of brute force by integers.
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include <sweepgrid/sap/quantizer.hpp>
#include <sweepgrid/sap/rounding.hpp>

#include "scene.hpp"

namespace clients {
namespace {

constexpr Regime kRegimes[] = {
    {"moving"},
    {"giants", 400, 24, Unit::kQuarter, 120, 15, true},
    {"crowd", 60, 30, Unit::kQuarter, 200, 8},
    {"denormal", 2000, 150, Unit::kDenormal},
    {"around_zero", 12, 4, Unit::kDenormal, 60, 15},
};

struct Digests {
  Digest events, counters;
  int wrong = 0;  ///< steps whose pairs are not those of brute force
};

void add_counters(const sweepgrid::StepCounters& c, Digest& digest) {
  for (const std::uint64_t count :
       {c.cells.swaps, c.cells.box_tests, c.cells.deltas, c.cells.endpoints_visited, c.cells.endpoints_sorted,
        c.cells.search_steps, c.cells.local_sorts, c.cells.global_sorts, c.cells.segments_split,
        c.cells.segments_merged, c.inserts, c.updates, c.erases, c.migrations, c.cell_ops, c.cells_drained, c.regrids,
        c.begins, c.ends}) {
    digest.add(count);
  }
}

template <class Scalar, int Dim>
Digests play(const Regime& regime, const sweepgrid::Config& config, bool exact) {
  using Engine = sweepgrid::Engine<Scalar, Dim>;
  Engine engine(config);
  Scene<Scalar, Dim> scene(regime, 7 * Dim + sizeof(Scalar));
  Digests digests;
  std::uint64_t next_key = 0;
  for (int step = 0; step < regime.steps; ++step) {
    std::vector<std::uint64_t> keys;
    std::vector<typename Engine::BoxType> boxes;
    std::vector<sweepgrid::Handle> handles;
    for (auto at = scene.objects.begin(); at != scene.objects.end();) {
      const std::int64_t fate = scene.random().below(20);
      if (fate == 0) {
        engine.erase(at->first);
        at = scene.objects.erase(at);
        continue;
      }
      if (fate < 8) {
        at->second = fate == 1 ? scene.place() : scene.near(at->second);
        if (fate % 2 == 0) {
          engine.update(at->first, scene.box(at->second));
        } else {
          handles.push_back(*engine.find(at->first));
          boxes.push_back(scene.box(at->second));
        }
      }
      ++at;
    }
    engine.update(handles, boxes);
    boxes.clear();
    while (scene.objects.size() < static_cast<std::size_t>(regime.objects)) {
      const auto steps = scene.place();
      keys.push_back(next_key);
      boxes.push_back(scene.box(steps));
      scene.objects.emplace(next_key++, steps);
    }
    engine.insert(keys, boxes);

    const auto& events = engine.step();
    digests.events.add(events.ends.size());
    for (const auto& pair : events.ends) digests.events.add(pair.first), digests.events.add(pair.second);
    for (const auto& pair : events.begins) digests.events.add(pair.first), digests.events.add(pair.second);
    add_counters(engine.stats().step, digests.counters);
    if (!exact) continue;
    const auto expected = scene.pairs();
    const auto pairs = engine.pairs();
    const bool right =
        std::equal(pairs.begin(), pairs.end(), expected.begin(), expected.end(),
                   [](const auto& a, const auto& b) { return a.first == b.first && a.second == b.second; });
    digests.wrong += right ? 0 : 1;
  }
  return digests;
}

bool report(const char* scalar, int dim, const char* regime, const char* setting, const Digests& alone,
            const Digests& together) {
  std::printf("%s %dD %s%s: events %016" PRIx64 ", counters %016" PRIx64 "\n", scalar, dim, regime, setting,
              alone.events.value(), alone.counters.value());
  if (alone.events.value() != together.events.value() || alone.counters.value() != together.counters.value()) {
    std::printf("  WRONG: other ones on three threads\n");
    return false;
  }
  if (alone.wrong + together.wrong == 0) return true;
  std::printf("  WRONG: %d steps have other pairs than brute force\n", alone.wrong + together.wrong);
  return false;
}

template <class Scalar, int Dim>
bool play_all(const char* scalar) {
  bool right = true;
  for (const Regime& regime : kRegimes) {
    if (regime.unit == Unit::kDenormal && !std::floating_point<Scalar>) continue;
    for (const bool margins : {false, true}) {
      sweepgrid::Config config;
      if (margins) config.envelope.emplace().margin = regime.unit == Unit::kDenormal ? 1e-44 : 0.75;
      Digests digests[2];
      for (int turn = 0; turn < 2; ++turn) {
        config.threads = turn == 0 ? 1 : 3;
        config.parallel_from = 0;
        digests[turn] = play<Scalar, Dim>(regime, config, !margins);
      }
      right &= report(scalar, Dim, regime.name, margins ? " with margins" : "", digests[0], digests[1]);
    }
  }
  return right;
}

/// What becomes of doubles of all kinds, NaN and infinity included.
void print_rounding() {
  Digest floats;
  Digest integers;
  Random random(3);
  const sweepgrid::Quantizer<std::int32_t, 3> quantize({0.3, -7, 1e6}, 0.01);
  const sweepgrid::Quantizer<std::int16_t, 3> coarse({0, 0, 0}, 1e-300);
  for (int i = 0; i < 20'000; ++i) {
    sweepgrid::Box<double, 3> box;
    for (int end = 0; end < 6; ++end) {
      // Numbers of any bits, or of common size and few bits.
      const double number =
          i % 2 == 0 ? std::bit_cast<double>(random.next()) : static_cast<double>(random.below(2001) - 1000) * 0x1p-3;
      (end < 3 ? box.min : box.max)[static_cast<std::size_t>(end % 3)] = number;
    }
    const auto rounded = sweepgrid::round_outward<float>(box);
    const auto fine = quantize(box);
    const auto small = coarse(box);
    floats.add(box.valid() ? 1 : 0);
    floats.add(rounded.valid() ? 1 : 0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      floats.add(std::bit_cast<std::uint32_t>(rounded.min[axis]));
      floats.add(std::bit_cast<std::uint32_t>(rounded.max[axis]));
      for (const std::int32_t end : {fine.min[axis], fine.max[axis]}) integers.add(static_cast<std::uint32_t>(end));
      for (const std::int16_t end : {small.min[axis], small.max[axis]}) integers.add(static_cast<std::uint16_t>(end));
    }
  }
  std::printf("rounded to floats %016" PRIx64 ", to integers %016" PRIx64 "\n", floats.value(), integers.value());
}

}  // namespace
}  // namespace clients

int main() {
  clients::print_rounding();
  bool right = clients::play_all<float, 2>("float");
  right &= clients::play_all<float, 3>("float");
  right &= clients::play_all<double, 2>("double");
  right &= clients::play_all<double, 3>("double");
  right &= clients::play_all<std::int32_t, 2>("int32");
  right &= clients::play_all<std::int32_t, 3>("int32");
  return right ? 0 : 1;
}
