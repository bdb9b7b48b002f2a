// Settings: what is refused, and what each does.
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <memory>

#include "engine_client.hpp"

namespace sweepgrid::engine_config_test {
namespace {

TEST(EngineConfig, RefusesWhatIsOutOfRangeAndNamesIt) {
  const auto refused = [](const std::function<void(Config&)>& change) {
    Config config = serial();
    change(config);
    return refusal([&] { Engine2 engine(config); });
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const int population : {0, -1, std::numeric_limits<int>::min()}) {
    EXPECT_TRUE(has(refused([&](Config& c) { c.cell_population = population; }), "cell_population"));
  }
  for (const double size : {0.0, -0.0, -1.0, nan, infinity, -infinity}) {
    EXPECT_TRUE(has(refused([&](Config& c) { c.cell_size = size; }), "cell_size"));
  }
  EXPECT_TRUE(has(refused([](Config& c) { c.threads = -1; }), "threads"));
  EXPECT_TRUE(has(refused([](Config& c) { c.parallel_from = -1; }), "parallel_from"));
  EXPECT_TRUE(has(refused([](Config& c) {
                    c.cell.kind = CellKind::kSegmented;
                    c.cell.segment_capacity = 3;
                  }),
                  "segment_capacity"));
  EXPECT_TRUE(has(refused([](Config& c) { c.cell.kind = static_cast<CellKind>(17); }), "kind"));
}

TEST(EngineConfig, AGivenCellSizeIsKeptButForBoundedGridsOfTooManyCells) {
  for (const Reduction reduction : {Reduction::kSingleReporter, Reduction::kWitnessCounts}) {
    Config config = through_cells();
    config.cell_size = 1e-9;
    config.reduction = reduction;
    Engine2 engine(config);
    for (std::uint64_t key = 0; key < 100; ++key) engine.insert(key, square(static_cast<float>(key), 0, 0));
    EXPECT_TRUE(engine.step().begins.empty());
    engine.validate();
    if (reduction == Reduction::kSingleReporter) {
      EXPECT_EQ(engine.stats().cell_size, 1e-9);
    } else {
      EXPECT_GE(engine.stats().cell_size, 100.0 / (1 << 24));
      EXPECT_LT(engine.stats().cell_size, 300.0 / (1 << 24));
    }
  }
}

/// Four workers, it says, and counts what it is given to do.
class Counting final : public Executor {
 public:
  [[nodiscard]] int concurrency() const override { return 4; }
  [[nodiscard]] int worker() const override { return 3; }
  void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override {
    ++loops;
    for (std::size_t i = 0; i < count; ++i) body(i);
  }
  void execute(const std::function<void()>& work) override { work(); }
  int loops = 0;
};

TEST(EngineConfig, ASmallStepIsDoneByItsCallerAlone) {
  for (const StepMethod method : {StepMethod::kCells, StepMethod::kSweep}) {
    const auto executor = std::make_shared<Counting>();
    Config config;
    config.step_method = method;
    config.executor = executor;
    config.parallel_from = 100;
    Engine2 engine(config);
    const auto loops_of_step = [&](std::uint64_t changes) {
      for (std::uint64_t key = 0; key < changes; ++key) {
        const double at = 0.5 * static_cast<double>(key + 1000 * engine.stats().steps);
        engine.contains(key) ? engine.update(key, square(at, 0)) : static_cast<void>(engine.insert(key, square(at, 0)));
      }
      const int before = executor->loops;
      engine.step();
      return executor->loops - before;
    };
    EXPECT_EQ(loops_of_step(99), 0);
    EXPECT_EQ(engine.pairs().size(), 98 + 97U);
    if (method == StepMethod::kCells) {
      EXPECT_GT(loops_of_step(101), 0);
      EXPECT_EQ(loops_of_step(50), 0);
    } else {
      EXPECT_EQ(loops_of_step(399), 0);
      EXPECT_GT(loops_of_step(400), 0);
      EXPECT_GT(loops_of_step(50), 0) << "all are swept";
    }
  }
}

TEST(EngineConfig, AnExecutorMayServeManyEngines) {
  Config config;
  config.executor = make_executor(3);
  Engine2 first(config);
  Engine2 second(config);
  for (std::uint64_t key = 0; key < 100; ++key) {
    first.insert(key, square(0.5F * key, 0));
    second.insert(key, square(0.5F * key, 0));
  }
  Events<std::uint64_t> events_of_first;
  std::thread other([&] { events_of_first = first.step(); });
  const auto events_of_second = second.step();
  other.join();
  EXPECT_EQ(events_of_first, events_of_second);
  EXPECT_EQ(events_of_second.begins.size(), 99u + 98u);
}

TEST(EngineConfig, ScenesOfEveryScaleWork) {
  for (const double unit : {5e-324, 1e-300, 1e-200, 1e-30, 1e30, 1e200, 1e307}) {
    Config config;
    config.threads = 1;
    config.cell_population = 1;
    Engine<double, 2> engine(config);
    for (std::uint64_t i = 0; i < 10; ++i) {
      const double x = static_cast<double>(i);
      engine.insert(i, Box<double, 2>({x * unit, 0}, {(x + 1) * unit, unit}));
    }
    EXPECT_EQ(engine.step().begins.size(), 9u) << unit;
    engine.validate();
  }
}

}  // namespace
}  // namespace sweepgrid::engine_config_test
