#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <sweepgrid/engine/engine.hpp>

#include "engine_client.hpp"
#include "engine_oracle.hpp"
#include "engine_pairing.hpp"

// Steps that sweep all objects from scratch: when they are taken, and what only they could get wrong.
namespace sweepgrid::engine_sweep_test {
namespace {

using oracle::Pairing;
using oracle::Random;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

Config config_of(StepMethod method, int threads = 1) {
  Config config;
  config.step_method = method;
  config.threads = threads;
  config.parallel_from = 0;
  return config;
}

Box<float, 3> cube(float x, float y, float z, float width = 1) {
  return {{x, y, z}, {x + width, y + width, z + width}};
}

class ManyCubes : public Pairing<float, 3> {
 public:
  ManyCubes(const Config& config, int count) : Pairing(config), count_(count) {}
  void move(int percent) {
    for (int key = 0; key < count_; ++key) {
      if (!random_.percent(percent)) continue;
      const auto at = [&] { return static_cast<float>(random_.below(1000)) / 50; };
      put(static_cast<std::uint64_t>(key), cube(at(), at(), at()));
    }
  }

 private:
  int count_;
  Random random_{5};
};

TEST(Sweep, IsTakenWhileMuchMovesAndCellsWhileLittleDoes) {
  for (const int threads : {1, 3}) {
    ManyCubes scene(config_of(StepMethod::kAuto, threads), 500);
    for (int phase = 0; phase < 4; ++phase) {
      const bool much = phase % 2 == 0;
      int swept = 0;
      for (int step = 0; step < 8; ++step) {
        scene.move(much ? 100 : 3);
        ASSERT_EQ(scene.step(), "") << "phase " << phase << ", step " << step;
        const Stats stats = scene.engine.stats();
        swept += static_cast<int>(stats.step.sweeps);
        EXPECT_EQ(stats.cells == 0, stats.step.sweeps == 1) << "cells are kept by steps that use them alone";
        EXPECT_EQ(stats.grids == 0, stats.step.sweeps == 1);
      }
      EXPECT_GE(much ? swept : 8 - swept, 4) << "phase " << phase;
      EXPECT_EQ(scene.engine.stats().step.sweeps, much ? 1u : 0u) << "phase " << phase;
    }
  }
}

TEST(Sweep, MethodsMayBeForced) {
  for (const StepMethod method : {StepMethod::kCells, StepMethod::kSweep}) {
    ManyCubes scene(config_of(method), 100);
    for (int step = 0; step < 12; ++step) {
      scene.move(step < 6 ? 100 : 2);
      ASSERT_EQ(scene.step(), "");
      if (step == 6) {
        ASSERT_EQ(scene.step(), "") << "an idle step";
      }
    }
    EXPECT_EQ(scene.engine.stats().total.sweeps, method == StepMethod::kSweep ? 12u : 0u);
  }
}

TEST(Sweep, IsNotTakenWhereItCannotBe) {
  Config config = config_of(StepMethod::kSweep);
  config.reduction = Reduction::kWitnessCounts;
  ManyCubes counted(config, 50);
  config.reduction = Reduction::kSingleReporter;
  config.cell.kind = CellKind::kBatch;
  ManyCubes batch(config, 50);
  for (ManyCubes* scene : {&counted, &batch}) {
    for (int step = 0; step < 3; ++step) {
      scene->move(100);
      ASSERT_EQ(scene->step(), "");
    }
    EXPECT_EQ(scene->engine.stats().total.sweeps, 0u);
    EXPECT_GT(scene->engine.stats().cells, 0u);
  }
}

// The boxes before a jump and after it are swept apart, so that each finds half of what happens.
TEST(Sweep, PairsThatJumpTogetherOrMeetOnBothSidesAreSilent) {
  Pairing<float, 3> scene(config_of(StepMethod::kSweep));
  Random random(3);
  for (std::uint64_t key = 100; key < 600; ++key) {  // so that rows are narrow
    const auto at = [&] { return static_cast<float>(random.below(1000)) / 10; };
    scene.put(key, cube(at(), at(), at()));
  }
  scene.put(1, cube(1, 1, 1));
  scene.put(2, cube(1.5, 1.5, 1.5));
  scene.put(3, cube(-5, -5, -5, 120));  // over everything
  scene.put(4, {{-kInfinity, 2, -kInfinity}, {kInfinity, 2, kInfinity}});
  ASSERT_EQ(scene.step(), "");
  for (const float to : {90.0F, 3.0F, 70.0F}) {
    scene.put(1, cube(to, to, 1));
    scene.put(2, cube(to + 0.5F, to, 1));
    ASSERT_EQ(scene.step(), "");
    for (const auto& [a, b] : scene.events->begins) EXPECT_FALSE(a < 5 && b < 4) << a << " and " << b;
    for (const auto& [a, b] : scene.events->ends) EXPECT_FALSE(a < 5 && b < 4) << a << " and " << b;
  }
  scene.put(1, cube(1, 1, 90));  // alone
  ASSERT_EQ(scene.step(), "");
  scene.put(2, cube(1, 1, 90));
  scene.erase(1);
  ASSERT_EQ(scene.step(), "");
}

TEST(Sweep, WhoIsEverywhereBeginsWithAllAndEndsWithAll) {
  oracle::meet_everywhere<float>();
  oracle::meet_everywhere<double>();
  oracle::meet_everywhere<std::int16_t>();
  oracle::meet_everywhere<std::int32_t>();
}

// Rows that were fitted to small boxes would hold each of the large ones a thousand times.
TEST(Sweep, BoxesThatGrowAllAtOnceGetOtherRowsInTheSameStep) {
  for (const int threads : {1, 3}) {
    Engine<float, 3> engine(config_of(StepMethod::kSweep, threads));
    Random random(2);
    std::vector<std::array<float, 3>> places;
    for (int key = 0; key < 20'000; ++key) {
      const auto at = [&] { return static_cast<float>(random.below(10'000)) / 100; };
      places.push_back({at(), at(), at()});
    }
    for (const float width : {0.5F, 0.6F, 0.5F}) {
      for (std::uint64_t key = 0; key < places.size(); ++key) {
        const auto& [x, y, z] = places[key];
        const Box<float, 3> box = cube(x, y, z, width);
        width == 0.5F && !engine.contains(key) ? static_cast<void>(engine.insert(key, box)) : engine.update(key, box);
      }
      engine.step();
    }
    const auto rows = engine.stats().step.cells_drained;
    EXPECT_GT(rows, 20u);
    for (std::uint64_t key = 0; key < places.size(); ++key) {  // a thin slab each, beside each other
      const float x = static_cast<float>(key) * 0.005F;
      engine.update(key, Box<float, 3>({x, -1000, -1000}, {x + 0.002F, 1000, 1000}));
    }
    engine.step();
    EXPECT_LT(engine.stats().step.cell_ops, 60'000u);
    EXPECT_TRUE(engine.pairs().empty());
    engine.validate();
  }
}

// What a whole scene can do in one step.
enum class Change { kNone, kShiftAlongOneAxis, kShiftAlongAll, kShrink, kGrow, kSpread, kGather };

std::array<Box<float, 3>, 2> before_and_after(Change change, Random& random, float extent) {
  const auto at = [&] { return static_cast<float>(random.below(10'000)) / 10'000 * extent; };
  const std::array<float, 3> place{at(), at(), at()};
  const auto box = [&](float scale, float shift, bool all, float width) {
    return cube(place[0] * scale + shift, place[1] * scale + (all ? shift : 0), place[2] * scale + (all ? shift : 0),
                width);
  };
  const Box<float, 3> usual = box(1, 0, false, 0.5F);
  switch (change) {
    case Change::kNone:
      return {usual, box(1, 0.01F, true, 0.5F)};
    case Change::kShiftAlongOneAxis:
      return {usual, box(1, 1e5F, false, 0.5F)};
    case Change::kShiftAlongAll:
      return {usual, box(1, -1e5F, true, 0.5F)};
    case Change::kShrink:
      return {box(1, 0, false, 2), box(1, 0, false, 0.02F)};
    case Change::kGrow:
      return {box(1, 0, false, 0.02F), box(1, 0, false, 2)};
    case Change::kSpread:
      return {usual, box(100, 0, false, 0.5F)};
    case Change::kGather:
      return {box(100, 0, false, 0.01F), box(1, 0, false, 0.01F)};
  }
  return {usual, usual};
}

constexpr std::array kChanges{
    Change::kNone,  Change::kShiftAlongOneAxis, Change::kShiftAlongAll, Change::kShrink, Change::kGrow, Change::kSpread,
    Change::kGather};

TEST(Sweep, IsExactWhileAWholeSceneChanges) {
  for (const Change change : kChanges) {
    for (const int threads : {1, 3}) {
      Pairing<float, 3> scene(config_of(StepMethod::kSweep, threads));
      Random random(11);
      std::vector<std::array<Box<float, 3>, 2>> boxes;
      for (int key = 0; key < 1200; ++key) boxes.push_back(before_and_after(change, random, 13));
      for (int step = 0; step < 6; ++step) {
        for (std::uint64_t key = 0; key < boxes.size(); ++key) {
          // Some come and go as all the others change.
          if (step >= 3 && key % 50 == 7) {
            if (step == 3) scene.erase(key);
          } else if (step >= 3 || key % 50 != 9) {
            scene.put(key, boxes[key][step < 3 ? 0 : 1]);
          }
        }
        ASSERT_EQ(scene.step(), "") << "change " << static_cast<int>(change) << ", step " << step;
      }
    }
  }
}

// Neither the rows for what boxes were nor those for what they are would do for both.
TEST(Sweep, AStepInWhichAWholeSceneChangesTakesAFewSweeps) {
  for (const Change change : kChanges) {
    for (const int threads : {1, 3}) {
      Engine<float, 3> engine(config_of(StepMethod::kSweep, threads));
      Random random(12);
      std::vector<std::array<Box<float, 3>, 2>> boxes;
      for (int key = 0; key < 12'000; ++key) boxes.push_back(before_and_after(change, random, 34));
      const auto work_of_step = [&](int state) {
        for (std::uint64_t key = 0; key < boxes.size(); ++key) {
          engine.contains(key) ? engine.update(key, boxes[key][state])
                               : static_cast<void>(engine.insert(key, boxes[key][state]));
        }
        engine.step();
        const StepCounters step = engine.stats().step;
        return 60 * step.cell_ops + step.cells.box_tests / 2;
      };
      work_of_step(0);
      Box<float, 3>& nudged = boxes[0][0];
      std::uint64_t calm = 0;
      for (int step = 0; step < 3; ++step) {
        for (int axis = 0; axis < 3; ++axis) nudged.min[axis] -= 0.01F;
        calm = work_of_step(0);
      }
      const std::uint64_t changed = work_of_step(1);
      Engine<float, 3> fresh(config_of(StepMethod::kSweep));
      for (std::uint64_t key = 0; key < boxes.size(); ++key) fresh.insert(key, boxes[key][1]);
      fresh.step();
      const StepCounters step = fresh.stats().step;
      const std::uint64_t anew = 60 * step.cell_ops + step.cells.box_tests / 2;
      EXPECT_LT(changed, 3 * (calm + anew)) << "change " << static_cast<int>(change);
      EXPECT_EQ(engine.pairs().size(), fresh.pairs().size());
      engine.validate();
    }
  }
}

// A sample of every so many objects would see nothing but the large ones.
TEST(Sweep, RowsDoNotDependOnTheOrderInWhichSizesCome) {
  std::uint64_t work[2];
  for (const bool shuffled : {false, true}) {
    Engine<float, 3> engine(config_of(StepMethod::kSweep));
    Random random(8);
    std::vector<std::uint64_t> order;
    for (std::uint64_t key = 0; key < 16'384; ++key) order.push_back(key);
    for (std::size_t i = order.size(); shuffled && i > 1; --i) {
      std::swap(order[i - 1], order[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
    }
    for (const std::uint64_t key : order) {
      const auto at = [&] { return static_cast<float>(random.below(100'000)) / 100; };
      engine.insert(key, cube(at(), at(), at(), key % 16 == 0 ? 150.0F : 1.0F));
    }
    engine.step();
    const StepCounters step = engine.stats().step;
    work[shuffled ? 1 : 0] = 60 * step.cell_ops + step.cells.box_tests / 2;
  }
  EXPECT_LT(work[0], work[1] * 3 / 2);
}

// Where everything ties, is thin, or lies far outside of where rows were fitted.
TEST(Sweep, IsExactWhereRowsFitBadly) {
  Pairing<float, 3> scene(config_of(StepMethod::kSweep, 2));
  Random random(4);
  for (int step = 0; step < 40; ++step) {
    const auto far = static_cast<float>(step * step * step) * 100;
    for (std::uint64_t key = 0; key < 200; ++key) {
      if (step > 0 && random.percent(20)) continue;
      const auto tick = [&] { return static_cast<float>(random.below(4)); };
      const float shift = key % 7 == 0 ? far : key % 11 == 0 ? -1e30F : 0;
      scene.put(key, cube(tick() + shift, tick(), key % 3 == 0 ? -0.0F : 0.0F, key % 5 == 0 ? 0 : tick()));
    }
    ASSERT_EQ(scene.step(), "") << "step " << step;
  }
}

}  // namespace
}  // namespace sweepgrid::engine_sweep_test
