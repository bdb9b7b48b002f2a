// When memory ends within a step, the step throws, and the engine is as if it had not been called.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine_oracle.hpp"

namespace {

// While it is on, allocations are numbered from 0, and those in [first, end) fail.
std::atomic<bool> counting = false;
std::atomic<std::int64_t> number = 0;
std::int64_t first_failure = 0;
std::int64_t end_of_failures = 0;

void* allocate(std::size_t bytes) {
  if (counting.load(std::memory_order_acquire)) {
    const std::int64_t own = number.fetch_add(1);
    if (own >= first_failure && own < end_of_failures) throw std::bad_alloc();
  }
  void* const memory = std::malloc(bytes == 0 ? 1 : bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t bytes) { return allocate(bytes); }
void* operator new[](std::size_t bytes) { return allocate(bytes); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace sweepgrid::oracle::engine_memory_test {
namespace {

/// Steps while `count` allocations from the given one on fail. Returns whether the step was done.
template <class EngineType>
bool step_without_memory(EngineType& engine, std::int64_t first, std::int64_t count) {
  number = 0;
  first_failure = first;
  end_of_failures = first + count;
  counting.store(true, std::memory_order_release);
  bool done = true;
  try {
    engine.step();
  } catch (const std::bad_alloc&) {
    done = false;
  }
  counting.store(false, std::memory_order_release);
  return done;
}

/// Steps that were tried in vain, and of these, those after which there was no memory for the cells either.
struct Failed {
  int steps = 0;
  int cells = 0;
};

/// Lets each step of a script fail at many of its allocations before it is done; says what was wrong and when.
template <class Scalar, int Dim>
std::string play_failing(const Config& config, SceneScript<Scalar, Dim> script, int steps, Failed& failed) {
  Engine<Scalar, Dim> engine(config);
  Engine<Scalar, Dim> other(config);
  std::vector<Pair<std::uint64_t>> pairs;
  for (int step = 0; step < steps; ++step) {
    const std::string when = "step " + std::to_string(step) + ": ";
    const EngineOps<Scalar, Dim> ops = script.next();
    queue(engine, ops, Calls::kBulk);
    queue(other, ops, Calls::kBulk);
    std::int64_t first = 0;
    bool has_cells = true;
    for (int attempt = 0;; ++attempt, first += 1 + first / 3) {
      const bool long_failure = attempt % 4 == 3;
      if (step_without_memory(engine, first, long_failure ? 1 << 20 : 1)) break;
      ++failed.steps;
      try {
        if (engine.pairs() != pairs)
          return when + "failed at allocation " + std::to_string(first) + ", pairs() is wrong";
        has_cells = true;
      } catch (const std::logic_error&) {
        if (has_cells && !long_failure) return when + "no cells, though but one allocation failed";
        has_cells = false;
        ++failed.cells;
      }
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
  Failed failed;
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
          const SceneScript<float, 3> script(regime, turn);
          EXPECT_EQ(play_failing(config, script, regime.steps, failed), "") << regime.name << ", turn " << turn;
        }
      }
    }
  }
  EXPECT_GT(failed.steps, 100);
  EXPECT_GT(failed.cells, 10);
}

}  // namespace
}  // namespace sweepgrid::oracle::engine_memory_test
