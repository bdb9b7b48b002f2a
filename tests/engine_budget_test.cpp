// A step beyond its budget, or without memory, is refused as a whole: nothing is reported or lost, and once it goes
// through, the events are those of an engine whose client had called step() only then.
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine_client.hpp"

namespace sweepgrid::oracle::engine_budget_test {
namespace {

/// What a client heard, step by step.
struct Heard {
  std::vector<StepStatus> statuses;
  std::vector<Events<std::uint64_t>> events;

  friend bool operator==(const Heard&, const Heard&) = default;
};

/// What differs; handles may.
std::string report_difference(const EnvelopeReport& expected, const EnvelopeReport& found) {
  std::string wrong;
  const auto compare = [&](const char* what, auto a, auto b) {
    if (a != b) wrong += std::string(what) + " " + std::to_string(b) + " instead of " + std::to_string(a) + "; ";
  };
  compare("steps", expected.steps, found.steps);
  compare("queries", expected.queries, found.queries);
  compare("early", expected.early, found.early);
  compare("violations", expected.violations, found.violations);
  compare("outside", expected.outside.size(), found.outside.size());
  compare("margin", expected.margin, found.margin);
  compare("candidates", expected.candidates, found.candidates);
  return wrong;
}

/// Plays a script with a limit that changes from step to step beside an engine without one, which steps only when the
/// limited one does; says what was wrong and when.
template <class Scalar, int Dim>
std::string play_limited(const Config& config, SceneScript<Scalar, Dim> script, int steps, std::uint64_t seed,
                         Heard& heard) {
  Engine<Scalar, Dim> limited(config);
  Engine<Scalar, Dim> free(config);
  Random random(seed);
  std::vector<Pair<std::uint64_t>> pairs;
  std::uint64_t refused = 0;
  for (int step = 0; step < steps; ++step) {
    const std::string when = "step " + std::to_string(step) + ": ";
    try {
      const EngineOps<Scalar, Dim> ops = script.next();
      queue(limited, ops, Calls::kBulk);
      queue(free, ops, Calls::kByKey);
      std::optional<std::uint64_t> limit;
      if (random.percent(70)) limit = std::uint64_t{1} << random.below(17);
      if (step + 1 == steps) limit.reset();
      limited.set_step_bytes(limit);
      const auto events = limited.step();
      heard.statuses.push_back(limited.status());
      heard.events.push_back(events);
      if (limited.status() == StepStatus::kOverBudget) {
        ++refused;
        if (!limit) return when + "refused without a limit";
        if (!events.begins.empty() || !events.ends.empty()) return when + "refused, but there are events";
        if (limited.pairs() != pairs) return when + "refused, but pairs() is not as it was";
      } else {
        const auto& expected = free.step();
        const std::string wrong = difference(expected, events);
        if (!wrong.empty()) return when + wrong;
        pairs = free.pairs();
        if (limited.pairs() != pairs) return when + "pairs() is wrong";
        const std::string report = report_difference(free.envelope_report(), limited.envelope_report());
        if (!report.empty()) return when + report;
        limited.validate();
      }
      if (limited.stats().refused != refused) return when + "stats() miscounts refused steps";
      if (limited.stats().pairs != pairs.size()) return when + "stats() has another number of pairs";
      if (limited.size() != free.size()) return when + "size() is wrong";
    } catch (const std::exception& error) {
      return when + error.what();
    }
  }
  return {};
}

const std::vector<SceneRegime>& regimes() {
  static const std::vector<SceneRegime> all = {
      {.name = "moving", .churn_percent = 10, .rebirth_percent = 5, .mayfly_percent = 5},
      {.name = "one point", .place = Place::kOnePoint, .travel = Travel::kJitter},
      {.name = "giants", .place = Place::kGiants, .churn_percent = 5},
      {.name = "sizes", .place = Place::kSizes, .travel = Travel::kResize, .churn_percent = 5},
      {.name = "all or nothing", .travel = Travel::kTeleport, .all_or_nothing = true},
      {.name = "growing", .population = 10, .last_population = 150, .churn_percent = 10, .pauses = true},
  };
  return all;
}

const std::vector<std::optional<EnvelopeOptions>>& envelopes() {
  static const std::vector<std::optional<EnvelopeOptions>> all = {
      std::nullopt,
      EnvelopeOptions{.margin = 2},
      EnvelopeOptions{.margin_steps = 1},
      EnvelopeOptions{.margin = 2, .exact = true},
      EnvelopeOptions{.swept = true},
      EnvelopeOptions{.margin = 4, .stride = 3},
      EnvelopeOptions{.margin = 4, .stride = 3, .on_violation = OnViolation::kQuery, .exact = true},
      EnvelopeOptions{.margin = 1, .swept = true, .stride = 2},
  };
  return all;
}

/// How many of the steps were refused, and how many not.
struct Counts {
  std::size_t refused = 0;
  std::size_t done = 0;
};

template <class Scalar, int Dim>
Counts play_all(const SceneRegime& regime) {
  Counts counts;
  std::size_t turn = 0;
  for (const auto& envelope : envelopes()) {
    for (const CellKind kind : kKinds) {
      for (const Reduction reduction : kReductions) {
        ++turn;
        if (kSanitized && turn % 5 != 0) continue;
        // Each envelope with each kind of cell, and one reduction.
        const std::size_t before = turn - 1;
        if (!kSanitized && !plays_all() && (before / 12 + before / 2 + before) % 2 != 0) continue;
        auto config = kGrids[2].template config<Dim>(kind, make_executor(1), reduction);
        if (reduction == Reduction::kSingleReporter) config.cell_population.reset();
        config.envelope = envelope;
        config.step_method = kStepMethods[turn / 2 % kStepMethods.size()];
        Heard heard;
        const SceneScript<Scalar, Dim> script(regime, turn);
        EXPECT_EQ(play_limited(config, script, regime.steps, turn, heard), "")
            << regime.name << ", turn " << turn << ", kind " << static_cast<int>(kind);
        for (const StepStatus status : heard.statuses) ++(status == StepStatus::kDone ? counts.done : counts.refused);
        if (turn % 3 != 0) continue;
        config.executor = make_executor(3);
        config.parallel_from = 0;
        Heard parallel;
        EXPECT_EQ(play_limited(config, script, regime.steps, turn, parallel), "") << regime.name << ", threads";
        EXPECT_TRUE(heard == parallel) << regime.name << ", turn " << turn << ": threads leave a trace";
      }
    }
  }
  return counts;
}

class BudgetScripts : public ::testing::TestWithParam<std::size_t> {};

TEST_P(BudgetScripts, RefusedStepsAreAsIfNeverCalled) {
  const SceneRegime& regime = regimes()[GetParam()];
  const Counts flat = play_all<double, 2>(regime);
  const Counts solid = play_all<float, 3>(regime);
  EXPECT_GT(10 * (flat.refused + solid.refused), flat.done + solid.done) << "too few steps were refused";
  EXPECT_GT(10 * (flat.done + solid.done), flat.refused + solid.refused) << "too few steps were done";
}

INSTANTIATE_TEST_SUITE_P(Regimes, BudgetScripts, ::testing::Range(std::size_t{0}, regimes().size()));

}  // namespace
}  // namespace sweepgrid::oracle::engine_budget_test

namespace sweepgrid::engine_budget_test {
namespace {

// 2000 objects at one point: two million pairs, whose deltas alone are 32 MB.
constexpr std::uint64_t kCrowd = 2000;
constexpr std::uint64_t kCrowdPairs = kCrowd * (kCrowd - 1) / 2;

std::vector<Handle> insert_crowd(Engine2& engine) {
  std::vector<std::uint64_t> keys;
  for (std::uint64_t key = 0; key < kCrowd; ++key) keys.push_back(key);
  return engine.insert(keys, std::vector<Box2>(kCrowd, square(0, 0)));
}

TEST(Budget, ACrowdAtOnePointIsRefusedLongBeforeItsPairsAreListed) {
  Config config = serial();
  config.step_bytes = 1 << 20;
  Engine2 engine(config);
  const auto crowd = insert_crowd(engine);
  EXPECT_TRUE(engine.step().begins.empty());
  EXPECT_EQ(engine.status(), StepStatus::kOverBudget);
  EXPECT_LT(engine.stats().bytes_queues, std::uint64_t{1} << 20);
  EXPECT_EQ(engine.size(), kCrowd);
  EXPECT_EQ(engine.stats().steps, 0U);
  EXPECT_EQ(engine.stats().refused, 1U);
  EXPECT_TRUE(engine.pairs().empty());
  engine.erase(std::span(crowd).subspan(100));
  EXPECT_EQ(engine.step().begins.size(), 4950U);
  EXPECT_EQ(engine.status(), StepStatus::kDone);
  engine.validate();
}

TEST(Budget, GoesThroughOnceTheLimitIsRaised) {
  Engine2 free(serial());
  insert_crowd(free);
  free.step();
  const StepCounters& step = free.stats().step;
  const std::uint64_t needed = 16 * step.cell_ops + 16 * step.cells.deltas + (8 + 2 * 16) * kCrowdPairs;
  Config config = serial();
  config.step_bytes = 1 << 20;
  Engine2 engine(config);
  insert_crowd(engine);
  engine.step();
  EXPECT_EQ(engine.status(), StepStatus::kOverBudget);
  engine.set_step_bytes(needed - 1);
  engine.step();
  EXPECT_EQ(engine.status(), StepStatus::kOverBudget);
  engine.set_step_bytes(needed);
  EXPECT_EQ(engine.step().begins.size(), kCrowdPairs);
  EXPECT_EQ(engine.status(), StepStatus::kDone);
}

TEST(Budget, OfCallsStopsWideBoxesThatVisitManyCells) {
  Config config = through_cells();
  config.step_bytes = 1 << 20;
  Engine2 engine(config);
  for (std::uint64_t key = 0; key < 4000; ++key) {
    engine.insert(key, square(static_cast<float>(key % 64) * 10, static_cast<float>(key / 64) * 10));
  }
  engine.step();
  ASSERT_EQ(engine.status(), StepStatus::kDone);
  for (std::uint64_t key = 4000; key < 4200; ++key) {
    const auto shift = static_cast<float>(key);
    engine.insert(key, Box2({-shift, -10000}, {-shift + 4300, -shift}));  // over all columns, beside all rows
  }
  engine.step();
  EXPECT_EQ(engine.status(), StepStatus::kOverBudget);
  engine.set_step_bytes(std::nullopt);
  EXPECT_GT(engine.step().begins.size(), 0U);
  engine.validate();
}

TEST(Budget, HandlesAndKeysOfARefusedStepAreAsTheirCallsLeftThem) {
  Engine2 engine(serial());
  const Handle a = engine.insert(1, square(0, 0));
  const Handle b = engine.insert(2, square(0.5F, 0));
  engine.step();
  engine.erase(a);
  const Handle c = engine.insert(1, square(0.25F, 0));
  engine.update(b, square(0.75F, 0));
  engine.set_step_bytes(1);
  for (int attempt = 0; attempt < 3; ++attempt) {
    engine.step();
    ASSERT_EQ(engine.status(), StepStatus::kOverBudget);
    EXPECT_TRUE(has(refusal([&] { engine.update(a, square(9, 9)); }), "stale"));
    EXPECT_EQ(engine.find(1), c);
    EXPECT_EQ(engine.box(b), square(0.75F, 0));
    EXPECT_EQ(engine.pairs(), (Pairs{{1, 2}}));
  }
  engine.set_step_bytes(std::nullopt);
  const auto& events = engine.step();
  EXPECT_EQ(events.ends, (Pairs{{1, 2}}));
  EXPECT_EQ(events.begins, (Pairs{{1, 2}}));
  EXPECT_TRUE(has(refusal([&] { engine.update(a, square(9, 9)); }), "stale"));
  const Handle d = engine.insert(3, square(5, 5));  // may take the place of a
  EXPECT_NE(d, a);
}

}  // namespace
}  // namespace sweepgrid::engine_budget_test
