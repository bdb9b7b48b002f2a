// What an engine says does not depend on how it is set up, and what it counts not on how it is run.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "engine_oracle.hpp"

namespace sweepgrid::oracle::engine_determinism_test {
namespace {

using Ops = EngineOps<float, 2>;
using Stream = std::vector<Events<std::uint64_t>>;

struct Record {
  Stream events;
  std::vector<StepCounters> counters;
};

std::vector<Ops> script_of(const SceneRegime& regime, std::uint64_t seed) {
  SceneScript<float, 2> script(regime, seed);
  std::vector<Ops> steps;
  for (int step = 0; step < regime.steps; ++step) steps.push_back(script.next());
  return steps;
}

/// Queues the inserts in order first, so that objects get the same ids whatever becomes of the rest.
void queue_inserts_first(Engine<float, 2>& engine, const Ops& ops, std::uint64_t seed) {
  Ops rest;
  for (const auto& op : ops) {
    if (op.kind == OpKind::kInsert) {
      engine.insert(op.key, op.box);
    } else {
      rest.push_back(op);
    }
  }
  queue(engine, shuffled(rest, seed), seed % 2 == 0 ? Calls::kByHandle : Calls::kFourThreads);
}

Record run(const std::vector<Ops>& steps, const Config& config, Calls calls = Calls::kByKey) {
  Engine<float, 2> engine(config);
  Record record;
  for (const Ops& ops : steps) {
    queue(engine, ops, calls);
    record.events.push_back(engine.step());
    record.counters.push_back(engine.stats().step);
  }
  return record;
}

/// The number of the first step that differs, -1 when none does.
template <class T>
int first_difference(const std::vector<T>& a, const std::vector<T>& b) {
  if (a.size() != b.size()) return 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!(a[i] == b[i])) return static_cast<int>(i);
  }
  return -1;
}

class EngineDeterminism : public ::testing::TestWithParam<SceneRegime> {
 protected:
  const std::vector<Ops> steps_ = script_of(GetParam(), 5);
};

TEST_P(EngineDeterminism, EventsAreTheSameForAllThreadsCellsAndGrids) {
  const Stream expected = run(steps_, kGrids[0].config<2>(CellKind::kPlane, make_serial_executor())).events;
  std::size_t turn = 0;
  for (const int threads : kThreadCounts) {
    if (kSanitized && threads == 2) continue;
    const auto executor = make_executor(threads);
    for (std::size_t k = 0; k < kKinds.size(); ++k) {
      for (std::size_t g = 0; g < kGrids.size(); ++g) {
        const GridChoice& grid = kGrids[g];
        // Each grid with each kind of cell, on half of the numbers of threads.
        if (!plays_all() && (k + g + static_cast<std::size_t>(threads)) % 2 != 0) continue;
        if (kSanitized && (k + static_cast<std::size_t>(threads)) % 3 != 0) continue;
        const Reduction reduction = kReductions[turn++ % 2];
        if (!grid.suits(GetParam().place, reduction)) continue;
        const Record other = run(steps_, grid.config<2>(kKinds[k], executor, reduction));
        EXPECT_EQ(first_difference(expected, other.events), -1)
            << threads << " threads, " << kKindNames[k] << ", " << grid.name;
      }
    }
  }
}

TEST_P(EngineDeterminism, EventsAreTheSameForEveryOrderOfCalls) {
  const auto executor = make_executor(3);
  const auto config = kGrids[1].config<2>(CellKind::kRows, executor);
  const Stream expected = run(steps_, config).events;
  for (std::uint64_t seed = 0; seed < (kSanitized ? 4 : 12); ++seed) {
    std::vector<Ops> other;
    for (const Ops& ops : steps_) other.push_back(shuffled(ops, seed));
    const Calls calls = kCalls[seed % kCalls.size()];
    EXPECT_EQ(first_difference(expected, run(other, config, calls).events), -1) << "seed " << seed;
  }
}

TEST_P(EngineDeterminism, CountersAreTheSameForAllThreads) {
  for (std::size_t k = 0; k < kKinds.size(); ++k) {
    for (const std::size_t g : {std::size_t{0}, std::size_t{1}, std::size_t{3}}) {
      const Reduction reduction = kReductions[(k + g) % 2];
      if (!kGrids[g].suits(GetParam().place, reduction)) continue;
      const auto config = [&](int threads) {
        return kGrids[g].config<2>(kKinds[k], make_executor(threads), reduction);
      };
      const Record expected = run(steps_, config(1));
      for (const int threads : {2, 3, 8}) {
        if (kSanitized && threads != 3) continue;
        EXPECT_EQ(first_difference(expected.counters, run(steps_, config(threads)).counters), -1)
            << threads << " threads, " << kKindNames[k] << ", " << kGrids[g].name;
      }
    }
  }
}

TEST_P(EngineDeterminism, CountersOfASceneAreTheSameWhenRunTwice) {
  const auto config = kGrids[1].config<2>(CellKind::kSegmented, make_executor(8));
  const Record once = run(steps_, config);
  const Record again = run(steps_, config);
  EXPECT_EQ(first_difference(once.counters, again.counters), -1);
  EXPECT_EQ(first_difference(once.events, again.events), -1);
}

const SceneRegime kEverything{.name = "EverythingAtOnce",
                              .churn_percent = 10,
                              .rebirth_percent = 10,
                              .mayfly_percent = 10,
                              .two_updates_percent = 30};
const SceneRegime kTies{.name = "Ties", .place = Place::kLattice, .churn_percent = 10, .rebirth_percent = 5};
const SceneRegime kGiantScene{.name = "Giants", .place = Place::kGiants, .churn_percent = 5, .steps = 6};
const SceneRegime kFar{.name = "FarOut", .place = Place::kFarOut, .churn_percent = 5, .steps = 8};
const SceneRegime kGrowth{
    .name = "Growth", .population = 5, .last_population = 400, .moving_percent = 30, .churn_percent = 5, .steps = 8};
const SceneRegime kSizeRatios{.name = "Sizes",
                              .place = Place::kSizes,
                              .travel = Travel::kResize,
                              .population = 400,
                              .churn_percent = 5,
                              .alternates = true,
                              .steps = 10};
const SceneRegime kDrifting{.name = "Drift", .travel = Travel::kDrift, .moving_percent = 100, .steps = 16};

INSTANTIATE_TEST_SUITE_P(Scenes, EngineDeterminism,
                         ::testing::Values(kEverything, kTies, kGiantScene, kFar, kGrowth, kSizeRatios, kDrifting),
                         [](const auto& scene) { return std::string(scene.param.name); });

// With as many objects every stage of the step runs in several tasks, the merge of events included.
class EngineDeterminismLarge : public ::testing::TestWithParam<CellKind> {};

TEST_P(EngineDeterminismLarge, EventsAndCountersAreTheSameForAllThreads) {
  const SceneRegime regime{.name = "Large",
                           .population = kSanitized ? 8000 : 12'000,
                           .moving_percent = 70,
                           .churn_percent = 5,
                           .rebirth_percent = 2,
                           .steps = 4};
  const std::vector<Ops> steps = script_of(regime, 1);
  const auto config = [](int threads) { return kGrids[0].config<2>(GetParam(), make_executor(threads)); };
  const Record expected = run(steps, config(1));
  ASSERT_GT(expected.events[1].begins.size(), 1500u) << "too few to be merged in several ranges";
  for (const int threads : {2, 3, 8}) {
    const Record other = run(steps, config(threads), threads == 3 ? Calls::kBulk : Calls::kByKey);
    EXPECT_EQ(first_difference(expected.events, other.events), -1) << threads << " threads";
    EXPECT_EQ(first_difference(expected.counters, other.counters), -1) << threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EngineDeterminismLarge, ::testing::ValuesIn(kKinds),
                         [](const auto& kind) { return std::string(kKindNames[kind.index]); });

TEST(EngineCounters, AreTheSameForEveryOrderOfUpdatesAndErases) {
  // A scene that only shrinks: all inserts are in its first step.
  for (const Place place : {Place::kUniform, Place::kLattice}) {
    SceneRegime regime{.name = "Moves", .place = place, .population = 300, .last_population = 60};
    regime.two_updates_percent = 30;
    regime.steps = 9;
    const std::vector<Ops> steps = script_of(regime, 3);
    for (const CellKind kind : kKinds) {
      std::vector<StepCounters> expected;
      for (std::uint64_t seed = 0; seed < 5; ++seed) {
        Engine<float, 2> engine(kGrids[1].config<2>(kind, make_executor(seed == 0 ? 1 : 3)));
        std::vector<StepCounters> counters;
        for (const Ops& ops : steps) {
          queue_inserts_first(engine, ops, seed);
          engine.step();
          counters.push_back(engine.stats().step);
        }
        if (seed == 0) expected = counters;
        EXPECT_EQ(first_difference(expected, counters), -1) << "seed " << seed;
      }
    }
  }
}

}  // namespace
}  // namespace sweepgrid::oracle::engine_determinism_test
