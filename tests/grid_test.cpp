#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include <sweepgrid/grid/grid.hpp>
#include <sweepgrid/grid/grid_fit.hpp>
#include <sweepgrid/grid/op_queues.hpp>

#include "op_script.hpp"

namespace sweepgrid {
namespace {

using Fit2 = GridFit<double, 2>;
using Box2 = Box<double, 2>;
using Spec2 = GridSpec<double, 2>;
using Range2 = CellRange<2>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Range2 range(std::uint16_t x0, std::uint16_t y0, std::uint16_t x1, std::uint16_t y1) { return {{x0, y0}, {x1, y1}}; }

bool share_a_cell(const Range2& a, const Range2& b) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (a.first[axis] > b.last[axis] || b.first[axis] > a.last[axis]) return false;
  }
  return true;
}

// ---- CellRange

TEST(CellRange, CountsAndContainsBothCorners) {
  const Range2 block = range(2, 3, 4, 3);
  EXPECT_EQ(block.count(), 3u);
  EXPECT_TRUE(block.contains({2, 3}));
  EXPECT_TRUE(block.contains({4, 3}));
  EXPECT_FALSE(block.contains({1, 3}));
  EXPECT_FALSE(block.contains({5, 3}));
  EXPECT_FALSE(block.contains({3, 2}));
  EXPECT_FALSE(block.contains({3, 4}));
}

TEST(CellRange, CountDoesNotOverflow) {
  const CellRange<3> all{{0, 0, 0}, {65535, 65535, 65535}};
  EXPECT_EQ(all.count(), std::uint64_t{1} << 48);
}

// ---- GridSpec

TEST(GridSpec, CoversTheBoundsWithCubicCells) {
  const Spec2 spec({0, 0}, {100, 41}, 10);
  EXPECT_EQ(spec.counts(), (Spec2::Counts{10, 5}));
  EXPECT_EQ(spec.cell_count(), 50u);
  EXPECT_EQ(spec.range(Box2({0, 0}, {9.5, 9.5})), range(0, 0, 0, 0));
  EXPECT_EQ(spec.range(Box2({5, 5}, {25, 12})), range(0, 0, 2, 1));
}

TEST(GridSpec, TouchesBothCellsAtAFace) {
  const Spec2 spec({0, 0}, {100, 100}, 10);
  EXPECT_EQ(spec.range(Box2({10, 20}, {10, 30})), range(1, 2, 1, 3));
}

TEST(GridSpec, BorderCellsReachToInfinity) {
  const Spec2 spec({0, 0}, {100, 100}, 10);
  EXPECT_EQ(spec.range(Box2({-1e30, -5}, {-1e29, -4})), range(0, 0, 0, 0));
  EXPECT_EQ(spec.range(Box2({1e30, 100}, {1e30, 1e300})), range(9, 9, 9, 9));
  EXPECT_EQ(spec.range(Box2({-kInfinity, 15}, {kInfinity, 15})), range(0, 1, 9, 1));
  EXPECT_EQ(spec.range(Box2({kInfinity, -kInfinity}, {kInfinity, -kInfinity})), range(9, 0, 9, 0));
}

TEST(GridSpec, OneCellTakesEverything) {
  const Spec2 spec;
  EXPECT_EQ(spec.cell_count(), 1u);
  EXPECT_EQ(spec.range(Box2({-kInfinity, 1e300}, {kInfinity, kInfinity})), range(0, 0, 0, 0));
  EXPECT_FALSE(spec.outside(Box2({-1e300, -1e300}, {-1e300, -1e300})));
}

TEST(GridSpec, OutsideMeansWhollyBeyondTheBounds) {
  const Spec2 spec({0, 0}, {100, 100}, 10);
  EXPECT_FALSE(spec.outside(Box2({-5, 50}, {5, 55})));
  EXPECT_FALSE(spec.outside(Box2({-kInfinity, 50}, {kInfinity, 55})));
  EXPECT_TRUE(spec.outside(Box2({-5, 50}, {-1, 55})));
  EXPECT_TRUE(spec.outside(Box2({50, 101}, {50, 102})));
}

TEST(GridSpec, IndexIsRowMajorWithTheLastAxisSlowest) {
  const Spec2 spec({0, 0}, {100, 40}, 10);
  EXPECT_EQ(spec.index({0, 0}), 0u);
  EXPECT_EQ(spec.index({9, 0}), 9u);
  EXPECT_EQ(spec.index({0, 1}), 10u);
  EXPECT_EQ(spec.index({9, 3}), 39u);
}

TEST(GridSpec, RefusesMoreCellsThanItCanNumber) {
  EXPECT_THROW((Spec2({0, 0}, {1, 1}, 1e-9)), std::invalid_argument);
  EXPECT_THROW((Spec2({0, 0}, {70'000, 0}, 1)), std::invalid_argument);
  EXPECT_THROW((Spec2({0, 0}, {5000, 5000}, 1)), std::invalid_argument);
  EXPECT_THROW((Spec2({-1e308, 0}, {1e308, 0}, 1)), std::invalid_argument);
  EXPECT_NO_THROW((Spec2({0, 0}, {65'536, 0}, 1)));
  EXPECT_NO_THROW((Spec2({0, 0}, {4096, 4096}, 1)));
}

// What the witness counts rest on: in whatever way coordinates are rounded, boxes that overlap meet in a cell.
template <class Scalar>
void expect_overlapping_boxes_share_a_cell(oracle::Palette palette, const std::array<double, 2>& lower, double size) {
  const GridSpec<Scalar, 2> spec(lower, {lower[0] + 100 * size, lower[1] + 50 * size}, size);
  const std::vector<Scalar> values = oracle::coordinates<Scalar>(palette);
  oracle::Random random(11);
  std::vector<Box<Scalar, 2>> boxes(150);
  for (auto& box : boxes) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto pick = [&] { return values[static_cast<std::size_t>(random.below(static_cast<int>(values.size())))]; };
      box.min[axis] = pick();
      box.max[axis] = pick();
      if (box.min[axis] > box.max[axis]) std::swap(box.min[axis], box.max[axis]);
    }
  }
  for (const auto& a : boxes) {
    const Range2 range_a = spec.range(a);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      ASSERT_LE(range_a.first[axis], range_a.last[axis]);
      ASSERT_LT(range_a.last[axis], spec.counts()[axis]);
    }
    for (const auto& b : boxes) {
      if (a.overlaps(b)) {
        ASSERT_TRUE(share_a_cell(range_a, spec.range(b)));
      }
    }
  }
}

TEST(GridSpec, OverlappingBoxesShareACellWhateverTheRounding) {
  for (const auto palette :
       {oracle::Palette::kFine, oracle::Palette::kLattice, oracle::Palette::kExtremes, oracle::Palette::kFar}) {
    for (const double size : {1e-320, 1e-40, 1e-3, 0.37, 1.0, 3.0, 1e3, 1e22, 1e28, 1e36}) {
      expect_overlapping_boxes_share_a_cell<float>(palette, {-50 * size, 0}, size);
      expect_overlapping_boxes_share_a_cell<double>(palette, {-50 * size, 0}, size);
      expect_overlapping_boxes_share_a_cell<float>(palette, {1e30, -1e30}, std::max(size, 1e18));
      if (size > 1e-3) expect_overlapping_boxes_share_a_cell<std::int64_t>(palette, {-50 * size, 0}, size);
    }
  }
}

// ---- GridFit

std::vector<Box2> uniform_boxes(int count, double space, double width, std::uint64_t seed = 1) {
  oracle::Random random(seed);
  std::vector<Box2> boxes;
  for (int i = 0; i < count; ++i) {
    const double x = space * random.below(1 << 20) / (1 << 20);
    const double y = space * random.below(1 << 20) / (1 << 20);
    boxes.push_back(Box2({x, y}, {x + width, y + width}));
  }
  return boxes;
}

/// Objects that the average object shares its cell with, itself included; by centre.
double crowding(const Spec2& spec, const std::vector<Box2>& boxes) {
  std::map<CellIndex, double> cells;
  for (const Box2& box : boxes) {
    const Box2::Point centre{(box.min[0] + box.max[0]) / 2, (box.min[1] + box.max[1]) / 2};
    cells[spec.index(spec.range(Box2(centre, centre)).first)] += 1;
  }
  double sum = 0;
  for (const auto& [cell, objects] : cells) sum += objects * objects;
  return sum / static_cast<double>(boxes.size());
}

TEST(GridFit, AimsAtTheWantedPopulation) {
  const auto boxes = uniform_boxes(8000, 1000, 0.1);
  for (const int population : {5, 48, 300}) {
    const Spec2 spec = Fit2{population, {}, {}}.derive(boxes, boxes.size());
    EXPECT_GT(crowding(spec, boxes), population * 0.5) << population;
    EXPECT_LT(crowding(spec, boxes), population * 2.0 + 2) << population;
  }
}

TEST(GridFit, HasNoMoreCellsThanObjectsBeyondAFloor) {
  const auto boxes = uniform_boxes(2000, 1000, 1e-6);
  const Spec2 spec = Fit2{1, {}, {}}.derive(boxes, boxes.size());
  EXPECT_LE(spec.cell_count(), 4096u + 2000u);
}

TEST(GridFit, CellsAreWiderThanMostBoxes) {
  const auto boxes = uniform_boxes(5000, 1000, 120);
  const Spec2 spec = Fit2{1, {}, {}}.derive(boxes, boxes.size());
  EXPECT_GE(spec.cell_size(), 120);
}

TEST(GridFit, AFewObjectsFarAwayDoNotStretchTheGrid) {
  auto boxes = uniform_boxes(3000, 100, 0.5);
  const double near = Fit2{}.derive(boxes, boxes.size()).cell_size();
  for (int i = 0; i < 5; ++i) boxes[static_cast<std::size_t>(600 * i)] = Box2({1e12, -1e12}, {1e12, 1e12});
  EXPECT_LT(Fit2{}.derive(boxes, boxes.size()).cell_size(), 2 * near);
}

TEST(GridFit, InfiniteBoxesDoNotCount) {
  auto boxes = uniform_boxes(1000, 100, 0.5);
  const double finite = Fit2{}.derive(boxes, boxes.size()).cell_size();
  boxes.push_back(Box2({-kInfinity, -1}, {kInfinity, 0}));
  boxes.push_back(Box2({-kInfinity, -kInfinity}, {kInfinity, 0}));
  EXPECT_NEAR(Fit2{}.derive(boxes, boxes.size()).cell_size(), finite, 0.1 * finite);
}

TEST(GridFit, NothingToGoByMakesOneCell) {
  EXPECT_EQ(Fit2{}.derive({}, 0).cell_count(), 1u);
  EXPECT_EQ(Fit2{}.derive({Box2({3, 3}, {3, 3})}, 1).cell_count(), 1u);
  EXPECT_EQ(Fit2{}.derive({Box2({-kInfinity, 0}, {kInfinity, 1})}, 1).cell_count(), 1u);
  EXPECT_EQ(Fit2{}.derive({Box2({-1e308, 0}, {-1e308, 1}), Box2({1.7e308, 0}, {1.7e308, 1})}, 2).cell_count(), 1u);
}

TEST(GridFit, DerivesAGridAtEveryScale) {
  for (const double unit : {5e-324, 1e-310, 1e-300, 1e-200, 1e-160, 1e-100, 1.0, 1e100, 1e160, 1e200, 1e300}) {
    for (const double width : {0.0, 1.0}) {
      std::vector<Box2> boxes;
      for (int i = 0; i < 10; ++i) boxes.push_back(Box2({i * unit, 0}, {(i + width) * unit, unit}));
      const Spec2 spec = Fit2{1, {}, {}}.derive(boxes, boxes.size());
      EXPECT_GE(spec.cell_count(), unit < 1e-300 ? 1u : 2u) << unit;
      EXPECT_LE(spec.cell_count(), 4106u) << unit;
    }
  }
}

TEST(GridFit, KeepsAGivenSizeUnlessTheGridWereTooLarge) {
  const auto boxes = uniform_boxes(100, 100, 1);
  Fit2 fit;
  fit.cell_size = 7;
  EXPECT_EQ(fit.derive(boxes, 100).cell_size(), 7);
  fit.cell_size = 1e-300;
  const Spec2 spec = fit.derive(boxes, 100);
  EXPECT_LE(spec.cell_count(), Spec2::kMaxCells);
  EXPECT_GT(spec.cell_count(), 1000u);
}

TEST(GridFit, KeepsGivenBounds) {
  Fit2 fit;
  fit.bounds = Box2({-1000, 0}, {1000, 500});
  const Spec2 spec = fit.derive(uniform_boxes(1000, 100, 1), 1000);
  EXPECT_TRUE(spec.outside(Box2({-1100, 0}, {-1001, 1})));
  EXPECT_FALSE(spec.outside(Box2({-999, 0}, {-998, 1})));
  EXPECT_GE(spec.counts()[0] * spec.cell_size(), 2000);
}

// ---- OpQueues

TEST(OpQueues, KeepOpsByBlockAndGroupInOrder) {
  OpQueues<float, 2> queues;
  queues.reset(2, 4);
  EXPECT_EQ(queues.blocks(), 2u);
  EXPECT_EQ(queues.groups(), 4u);
  for (ObjectId object = 0; object < 8; ++object) queues.push(object % 2, object, {object, OpKind::kErase, {}});
  for (std::size_t block = 0; block < 2; ++block) {
    for (std::size_t group = 0; group < 4; ++group) {
      std::vector<ObjectId> objects;
      for (const auto& routed : queues.list(block, group)) {
        EXPECT_EQ(queues.group_of(routed.cell), group);
        objects.push_back(routed.op.object);
      }
      const auto first = static_cast<ObjectId>(group);
      EXPECT_EQ(objects, group % 2 == block ? (std::vector<ObjectId>{first, first + 4}) : std::vector<ObjectId>{});
    }
  }
  queues.reset(2, 4);
  for (std::size_t group = 0; group < 4; ++group) EXPECT_TRUE(queues.list(0, group).empty());
}

// ---- Grid

/// A grid with the ranges that its client keeps, one block and one group.
class GridClient {
 public:
  GridClient() { grid_.reset(Spec2({0, 0}, {40, 40}, 10), CellOptions{}); }

  void begin() { grid_.begin_step(1, 1); }
  void insert(ObjectId object, const Box2& box) { grid_.route_insert(0, object, box, ranges_[object]); }
  bool update(ObjectId object, const Box2& box) { return grid_.route_update(0, object, box, ranges_[object]); }
  void erase(ObjectId object) { grid_.route_erase(0, object, ranges_[object]); }

  /// The sum of each pair's deltas.
  std::map<PairKey, int> end() {
    std::vector<OverlapDelta> deltas;
    grid_.gather(0);
    for (const auto& active : grid_.active(0)) grid_.drain(0, active, deltas, counters_);
    std::map<PairKey, int> sums;
    for (const OverlapDelta& delta : deltas) sums[delta.pair] += delta.change;
    return sums;
  }

  [[nodiscard]] std::vector<CellIndex> cells_with(ObjectId object) const {
    std::vector<CellIndex> cells;
    for (CellIndex cell = 0; cell < grid_.spec().cell_count(); ++cell) {
      if (grid_.cell(cell) == nullptr) continue;
      std::vector<SweepAndPrune<double, 2>::Resident> residents;
      grid_.cell(cell)->append_residents(residents);
      for (const auto& resident : residents) {
        if (resident.object == object) cells.push_back(cell);
      }
    }
    return cells;
  }
  [[nodiscard]] const Grid<double, 2>& grid() const { return grid_; }

 private:
  Grid<double, 2> grid_;
  std::map<ObjectId, Range2> ranges_;
  SapCounters counters_;
};

using Cells = std::vector<CellIndex>;
using Sums = std::map<PairKey, int>;

TEST(Grid, ABoxLivesInExactlyTheCellsOfItsRange) {
  GridClient client;
  client.begin();
  client.insert(7, Box2({5, 5}, {15, 5}));
  client.end();
  EXPECT_EQ(client.cells_with(7), (Cells{0, 1}));

  client.begin();
  EXPECT_FALSE(client.update(7, Box2({6, 6}, {16, 6})));
  client.end();
  EXPECT_EQ(client.cells_with(7), (Cells{0, 1}));

  client.begin();
  EXPECT_TRUE(client.update(7, Box2({15, 15}, {16, 16})));
  client.end();
  EXPECT_EQ(client.cells_with(7), (Cells{5}));

  client.begin();
  client.erase(7);
  client.end();
  EXPECT_EQ(client.cells_with(7), (Cells{}));
}

TEST(Grid, CountsAPairInEveryCellWhereItOverlaps) {
  GridClient client;
  client.begin();
  client.insert(1, Box2({5, 5}, {25, 5}));
  client.insert(2, Box2({8, 5}, {12, 5}));
  EXPECT_EQ(client.end(), (Sums{{PairKey(1, 2), 2}}));
}

TEST(Grid, AMigrationLeavesTheSumOfAPairThatStays) {
  GridClient client;
  client.begin();
  client.insert(1, Box2({5, 5}, {9, 9}));
  client.insert(2, Box2({5, 5}, {9, 9}));
  EXPECT_EQ(client.end(), (Sums{{PairKey(1, 2), 1}}));
  client.begin();
  EXPECT_TRUE(client.update(1, Box2({15, 5}, {19, 9})));
  EXPECT_TRUE(client.update(2, Box2({15, 5}, {19, 9})));
  EXPECT_EQ(client.end(), (Sums{{PairKey(1, 2), 0}}));
}

TEST(Grid, OnlyCellsWithOpsAreActiveAndComeInOrder) {
  GridClient client;
  client.begin();
  client.insert(1, Box2({35, 35}, {36, 36}));
  client.insert(2, Box2({5, 5}, {6, 6}));
  client.insert(3, Box2({15, 5}, {16, 6}));
  client.end();
  client.begin();
  client.update(1, Box2({35, 35}, {37, 37}));
  client.update(2, Box2({5, 5}, {7, 7}));
  client.end();
  Cells active;
  for (const auto& cell : client.grid().active(0)) {
    active.push_back(cell.cell);
    EXPECT_EQ(cell.op_count, 1u);
    EXPECT_EQ(cell.population, 1u);
  }
  EXPECT_EQ(active, (Cells{0, 15}));
}

TEST(Grid, AnEmptyCellIsDropped) {
  GridClient client;
  client.begin();
  client.insert(1, Box2({5, 5}, {6, 6}));
  client.end();
  EXPECT_NE(client.grid().cell(0), nullptr);
  client.begin();
  client.erase(1);
  client.end();
  EXPECT_EQ(client.grid().cell(0), nullptr);
}

TEST(Grid, ResetDropsAllCells) {
  Grid<double, 2> grid;
  grid.reset(Spec2({0, 0}, {40, 40}, 10), CellOptions{});
  grid.begin_step(1, 1);
  Range2 range;
  grid.route_insert(0, 1, Box2({0, 0}, {100, 100}), range);
  grid.gather(0);
  std::vector<OverlapDelta> deltas;
  SapCounters counters;
  for (const auto& active : grid.active(0)) grid.drain(0, active, deltas, counters);
  EXPECT_GT(grid.cell_bytes(), 0u);
  grid.reset(Spec2({0, 0}, {20, 20}, 10), CellOptions{});
  EXPECT_EQ(grid.spec().cell_count(), 4u);
  for (CellIndex cell = 0; cell < 4; ++cell) EXPECT_EQ(grid.cell(cell), nullptr);
}

}  // namespace
}  // namespace sweepgrid
