// When memory ends within a step, the step throws, and the engine is as if it had not been called.
#include <gtest/gtest.h>

#include <cstdint>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine_oracle.hpp"
#include "watched_heap.hpp"

namespace sweepgrid::oracle::engine_memory_test {
namespace {

/// Steps while `count` allocations from the given one on fail. Returns whether the step was done.
template <class EngineType>
bool step_without_memory(EngineType& engine, std::int64_t first, std::int64_t count) {
  const heap::Failing failing(first, count);
  try {
    engine.step();
  } catch (const std::bad_alloc&) {
    return false;
  }
  return true;
}

/// Lets each step of a script fail at many of its allocations before it is done; says what was wrong and when.
template <class Scalar, int Dim>
std::string play_failing(const Config& config, SceneScript<Scalar, Dim> script, int steps, int& failed) {
  Engine<Scalar, Dim> engine(config);
  Engine<Scalar, Dim> other(config);
  std::vector<Pair<std::uint64_t>> pairs;
  for (int step = 0; step < steps; ++step) {
    const std::string when = "step " + std::to_string(step) + ": ";
    const EngineOps<Scalar, Dim> ops = script.next();
    queue(engine, ops, Calls::kBulk);
    queue(other, ops, Calls::kBulk);
    std::int64_t first = 0;
    for (int attempt = 0;; ++attempt, first += 1 + first / 3) {
      const bool long_failure = attempt % 4 == 3;
      if (step_without_memory(engine, first, long_failure ? 1 << 20 : 1)) break;
      ++failed;
      if (engine.pairs() != pairs) return when + "failed at allocation " + std::to_string(first) + ", pairs() is wrong";
    }
    // The step that was done has handed out its events already, so they are told from the pairs.
    const Events<std::uint64_t>& expected = other.step();
    const auto stats = engine.stats();
    if (stats.step.begins != expected.begins.size()) return when + "another number of begins";
    if (stats.step.ends != expected.ends.size()) return when + "another number of ends";
    pairs = other.pairs();
    const std::string wrong = difference("pairs", pairs, engine.pairs());
    if (!wrong.empty()) return when + wrong;
    engine.validate();
  }
  return {};
}

// On one thread, because oneTBB hangs when its own allocations fail.
TEST(WithoutMemory, AStepIsDoneWhollyOrNotAtAll) {
  const std::vector<SceneRegime> regimes = {
      {.name = "moving", .churn_percent = 10, .rebirth_percent = 5, .mayfly_percent = 5, .steps = 6},
      {.name = "sizes", .place = Place::kSizes, .travel = Travel::kResize, .churn_percent = 5, .steps = 4},
      {.name = "growing", .population = 10, .last_population = 150, .steps = 6},
  };
  const std::vector<std::optional<EnvelopeOptions>> envelopes = {
      std::nullopt, EnvelopeOptions{.margin = 2, .margin_steps = 1}, EnvelopeOptions{.swept = true, .stride = 2}};
  int failed = 0;
  std::uint64_t turn = 0;
  for (const SceneRegime& regime : regimes) {
    for (const auto& envelope : envelopes) {
      for (const CellKind kind : kKinds) {
        for (const Reduction reduction : kReductions) {
          ++turn;
          if (kSanitized && turn % 7 != 0) continue;
          auto config = kGrids[2].config<3>(kind, make_executor(1), reduction);
          if (reduction == Reduction::kSingleReporter) config.cell_population.reset();
          config.envelope = envelope;
          config.step_method = kStepMethods[turn / 2 % kStepMethods.size()];
          const SceneScript<float, 3> script(regime, turn);
          EXPECT_EQ(play_failing(config, script, regime.steps, failed), "") << regime.name << ", turn " << turn;
        }
      }
    }
  }
  EXPECT_GT(failed, 100);
}

}  // namespace
}  // namespace sweepgrid::oracle::engine_memory_test
