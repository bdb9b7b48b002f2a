// Statistics: what is counted, and how the grids follow the scene.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>

#include "engine_client.hpp"

namespace sweepgrid::engine_stats_test {
namespace {

TEST(EngineStats, CountWhatHappened) {
  Config config = through_cells();
  config.cell.kind = CellKind::kBatch;
  config.cell_size = 10;
  Engine2 engine(config);
  engine.insert(1, square(5, 5, 0));  // points, so that each is in one cell, wherever the grid begins
  engine.insert(2, square(5, 5, 0));
  engine.insert(3, square(105, 5, 0));
  engine.step();
  Stats stats = engine.stats();
  EXPECT_EQ(stats.steps, 1u);
  EXPECT_EQ(stats.objects, 3u);
  EXPECT_EQ(stats.pairs, 1u);
  EXPECT_EQ(stats.grids, 1u);
  EXPECT_EQ(stats.cells, 2u);
  EXPECT_EQ(stats.cell_size, 10);
  EXPECT_EQ(stats.step.inserts, 3u);
  EXPECT_EQ(stats.step.cell_ops, 3u);
  EXPECT_EQ(stats.step.cells_drained, 2u);
  EXPECT_EQ(stats.step.begins, 1u);
  EXPECT_EQ(stats.step.cells.deltas, 1u);
  EXPECT_GT(stats.bytes_objects, 0u);
  EXPECT_GT(stats.bytes_cells, 0u);
  EXPECT_EQ(stats.bytes_witnesses, 0u);

  engine.update(std::uint64_t{1}, square(35, 5, 0));  // migrates: one erase, one insert
  engine.update(std::uint64_t{2}, square(5, 5, 0));   // rests
  engine.erase(std::uint64_t{3});
  engine.step();
  stats = engine.stats();
  EXPECT_EQ(stats.steps, 2u);
  EXPECT_EQ(stats.step.inserts, 0u);
  EXPECT_EQ(stats.step.updates, 1u);
  EXPECT_EQ(stats.step.migrations, 1u);
  EXPECT_EQ(stats.step.erases, 1u);
  EXPECT_EQ(stats.step.cell_ops, 2u + 1u);
  EXPECT_EQ(stats.step.ends, 1u);
  EXPECT_EQ(stats.cells, 2u);
  EXPECT_EQ(stats.total.inserts, 3u);
  EXPECT_EQ(stats.total.begins, 1u);
  EXPECT_EQ(stats.total.ends, 1u);
  EXPECT_EQ(stats.step.regrids, 0u);

  engine.step();
  EXPECT_EQ(engine.stats().step, StepCounters{});
  EXPECT_EQ(engine.stats().steps, 3u);
}

TEST(EngineStats, GridsAreMadeForSizesThatExistAndGoWithThem) {
  Config config = through_cells();
  config.cell_size = 1;
  Engine2 engine(config);
  for (std::uint64_t key = 0; key < 10; ++key) engine.insert(key, square(static_cast<float>(3 * key), 0));
  engine.step();
  EXPECT_EQ(engine.stats().grids, 1u);
  const Handle wide = engine.insert(10, square(0, 0, 30));
  EXPECT_EQ(engine.step().begins.size(), 10u);
  EXPECT_EQ(engine.stats().grids, 2u);
  const Handle endless = engine.insert(11, Box2({-kInfinity, 0}, {kInfinity, 0}));
  EXPECT_EQ(engine.step().begins.size(), 11u);
  EXPECT_EQ(engine.stats().grids, 3u);
  engine.erase(wide);
  engine.erase(endless);
  EXPECT_EQ(engine.step().ends.size(), 21u);
  EXPECT_EQ(engine.stats().grids, 1u);
  EXPECT_EQ(engine.stats().cell_size, 1);
}

TEST(EngineStats, ACrowdAtOnePointKeepsItsCells) {
  Engine2 engine(through_cells());
  for (std::uint64_t key = 0; key < 300; ++key) engine.insert(key, square(0, 0, 1));
  engine.step();
  for (int step = 1; step < 6; ++step) {
    for (std::uint64_t key = 0; key < 300; ++key) {
      engine.update(key, square(static_cast<float>(step * key) * 1e-5F, static_cast<float>(key) * 1e-5F, 1));
    }
    engine.step();
  }
  EXPECT_EQ(engine.stats().total.regrids, 1u);  // the first: no other cells would divide such a crowd
}

TEST(EngineStats, ABoxOverEverythingIsInFewCellsOfABoundedGrid) {
  Config config = through_cells();
  config.reduction = Reduction::kWitnessCounts;
  config.cell_population = 2;
  Engine2 engine(config);
  oracle::Random random(1);
  for (std::uint64_t key = 0; key < 500; ++key) {
    const float space = key % 20 == 0 ? 1e5F : 1;  // cells for the crowd would be millions over the rest
    const float x = space * static_cast<float>(random.below(1000)) / 1000;
    engine.insert(key, square(x, space * static_cast<float>(random.below(1000)) / 1000, 1e-4F));
  }
  const std::size_t begins = engine.step().begins.size();
  EXPECT_LE(engine.stats().cells, 500u * 4);
  engine.insert(500, Box2({-kInfinity, -kInfinity}, {kInfinity, kInfinity}));
  EXPECT_EQ(engine.step().begins.size(), 500u);
  EXPECT_EQ(engine.stats().pairs, begins + 500);
  EXPECT_LE(engine.stats().cells, 4096u + 501);
  EXPECT_GT(engine.stats().cells, 500u);
  engine.validate();
}

TEST(EngineStats, OnlyWitnessCountsKeepATableOfPairs) {
  for (const Reduction reduction : {Reduction::kSingleReporter, Reduction::kWitnessCounts}) {
    Config config = through_cells();
    config.reduction = reduction;
    Engine2 engine(config);
    for (std::uint64_t key = 0; key < 50; ++key) engine.insert(key, square(0, 0));
    engine.step();
    EXPECT_EQ(engine.stats().pairs, 50u * 49 / 2);
    EXPECT_EQ(engine.stats().bytes_witnesses > 0, reduction == Reduction::kWitnessCounts);
    EXPECT_EQ(engine.pairs().size(), 50u * 49 / 2);
  }
}

TEST(EngineStats, AGrowingSceneMakesTheGridAnewOnce) {
  for (const Reduction reduction : {Reduction::kSingleReporter, Reduction::kWitnessCounts}) {
    Config config = through_cells();
    config.reduction = reduction;
    Engine2 engine(config);
    for (std::uint64_t key = 0; key < 10; ++key) engine.insert(key, square(static_cast<float>(20 * key), 0));
    engine.step();
    EXPECT_EQ(engine.stats().step.regrids, 1u);
    const std::size_t cells = engine.stats().cells;
    for (std::uint64_t key = 10; key < 5000; ++key) {
      engine.insert(key, square(static_cast<float>(key % 70) * 3, static_cast<float>(key / 70) * 3));
    }
    engine.step();
    EXPECT_EQ(engine.stats().step.regrids, 1u);
    EXPECT_GT(engine.stats().cells, 2 * cells);
    engine.step();
    EXPECT_EQ(engine.stats().step.regrids, 0u);
  }
}

/// 2000 objects in a square of that edge, centred at `centre`.
void queue_square(Engine2& engine, float centre, float edge) {
  oracle::Random random(1);
  for (std::uint64_t key = 0; key < 2000; ++key) {
    const auto place = [&] { return centre + edge * (static_cast<float>(random.below(1000)) / 1000 - 0.5F); };
    const float x = place();
    const Box2 box = square(x, place(), edge / 1000);
    if (engine.contains(key)) {
      engine.update(key, box);
    } else {
      engine.insert(key, box);
    }
  }
}

TEST(EngineStats, ASceneThatCollapsesGetsSmallerCells) {
  for (const Reduction reduction : {Reduction::kSingleReporter, Reduction::kWitnessCounts}) {
    Config config = through_cells();
    config.reduction = reduction;
    Engine2 engine(config);
    float edge = 1024;
    queue_square(engine, 0, edge);
    engine.step();
    const double size = engine.stats().cell_size;
    for (; edge > 1; edge /= 2) {
      queue_square(engine, 0, edge);
      engine.step();
    }
    for (int step = 0; step < 8; ++step) {  // if it still follows
      queue_square(engine, 0.01F * static_cast<float>(step % 2), edge);
      engine.step();
    }
    EXPECT_LT(engine.stats().cell_size, size / 512);
    EXPECT_GT(engine.stats().cell_size, size / 2048);
    EXPECT_LT(engine.stats().total.regrids, 10u);
  }
}

TEST(EngineStats, ASceneThatLeavesItsPlaceKeepsItsCells) {
  Config config = through_cells();
  for (const Reduction reduction : {Reduction::kSingleReporter, Reduction::kWitnessCounts}) {
    config.reduction = reduction;
    Engine2 engine(config);
    queue_square(engine, 0, 100);
    engine.step();
    const std::size_t cells = engine.stats().cells;
    for (int step = 0; step < 3; ++step) {
      queue_square(engine, 5000.0F + static_cast<float>(step), 100);
      engine.step();
    }
    EXPECT_GT(engine.stats().cells, cells / 2);
    // A grid without bounds serves everywhere; one with bounds is made anew where the scene is now.
    EXPECT_EQ(engine.stats().total.regrids, reduction == Reduction::kSingleReporter ? 1u : 2u);
  }
}

TEST(EngineStats, ASceneThatStaysKeepsItsGrid) {
  Engine2 engine(through_cells());
  for (int step = 0; step < 20; ++step) {
    queue_square(engine, static_cast<float>(step % 3), 100);
    engine.step();
  }
  EXPECT_EQ(engine.stats().total.regrids, 1u);
}

TEST(EngineStats, ACrowdThatMovesOnlySometimesKeepsItsGrid) {
  Engine2 engine(through_cells());
  constexpr int kCold = 2000;
  constexpr int kHot = 400;
  const auto box_of = [](int object, int step) {
    const auto shift = static_cast<float>(step % 2) * 1e-4F;
    if (object >= kCold) return square(500 + static_cast<float>(object - kCold) * 1e-5F + shift, 500);
    return square(static_cast<float>(object * 37 % 1000) + shift, static_cast<float>(object * 61 % 1009));
  };
  for (int object = 0; object < kCold + kHot; ++object) engine.insert(object, box_of(object, 0));
  engine.step();
  for (int step = 1; step < 30; ++step) {
    const bool hot = step % 3 == 0;
    for (int object = hot ? kCold : 0; object < (hot ? kCold + kHot : kCold); ++object) {
      engine.update(object, box_of(object, step));
    }
    engine.step();
  }
  EXPECT_LE(engine.stats().total.regrids, 2u);
}

TEST(EngineStats, AnIdleStepTookNoTime) {
  Engine2 engine(through_cells());
  engine.insert(1, square(0, 0));
  engine.step();
  engine.step();
  for (const StageTime& stage : engine.stats().stages) EXPECT_EQ(stage.seconds, 0);
}

TEST(EngineStats, TasksAreRecordedOnDemand) {
  Engine2 engine(through_cells());
  engine.insert(1, square(0, 0));
  engine.step();
  EXPECT_TRUE(engine.tasks().empty());
  engine.record_tasks(true);
  engine.insert(2, square(0, 0));
  engine.step();
  EXPECT_FALSE(engine.tasks().empty());
  EXPECT_EQ(engine.stage_names().size(), engine.stats().stages.size());
  for (const TaskRecord& task : engine.tasks()) EXPECT_LT(task.stage, engine.stage_names().size());
}

}  // namespace
}  // namespace sweepgrid::engine_stats_test
