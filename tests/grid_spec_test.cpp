// From boxes to cells: codes, ranges, the cutting of space, and where a grid should lie.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <sweepgrid/grid/cell_code.hpp>
#include <sweepgrid/grid/cell_range.hpp>
#include <sweepgrid/grid/grid_fit.hpp>
#include <sweepgrid/grid/grid_fit.inl.hpp>
#include <sweepgrid/grid/grid_spec.hpp>

#include "op_script.hpp"

namespace sweepgrid::grid_spec_test {
namespace {

using Fit2 = GridFit<double, 2>;
using Box2 = Box<double, 2>;
using Spec2 = GridSpec<double, 2>;
using Range2 = CellRange<2>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Range2 range(std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) { return {{x0, y0, x1, y1}}; }

/// Cells of 10 from 0 to 40 on both axes; the outer ones reach to infinity.
Spec2 four_by_four() { return Spec2(10, {0, 0}, {3, 3}); }

// ---- CellCode

template <int Dim>
void expect_codes_are_coordinates() {
  using Code = CellCode<Dim>;
  oracle::Random random(Dim);
  std::map<std::uint64_t, CellCoordinates<Dim>> seen;
  for (int i = 0; i < 3000; ++i) {
    CellCoordinates<Dim> cell;
    for (auto& c : cell) {
      const auto high = static_cast<int>(Code::kLastCoordinate);
      c = static_cast<std::uint32_t>(i % 3 == 0   ? random.below(8)
                                     : i % 3 == 1 ? high - random.below(8)
                                                  : random.between(0, high));
    }
    const std::uint64_t code = Code::of(cell);
    ASSERT_EQ(Code::coordinates(code), cell);
    ASSERT_EQ(Code::block(code) << Code::kBlockShift | Code::inner(code), code);
    ASSERT_LT(Code::inner(code), Code::kBlockCells);
    const auto [entry, fresh] = seen.emplace(code, cell);
    ASSERT_EQ(entry->second, cell) << "two cells have one code";
  }
}

TEST(CellCode, TellsEveryCellFromEveryOther) {
  expect_codes_are_coordinates<1>();
  expect_codes_are_coordinates<2>();
  expect_codes_are_coordinates<3>();
  expect_codes_are_coordinates<4>();
  expect_codes_are_coordinates<7>();
}

TEST(CellCode, ABlockIsACubeOfNeighbours) {
  using Code = CellCode<3>;
  std::set<std::uint32_t> inner;
  for (std::uint32_t x = 4; x < 8; ++x) {
    for (std::uint32_t y = 0; y < 4; ++y) {
      for (std::uint32_t z = 8; z < 12; ++z) {
        EXPECT_EQ(Code::block(Code::of({x, y, z})), Code::block(Code::of({4, 0, 8})));
        inner.insert(Code::inner(Code::of({x, y, z})));
      }
    }
  }
  EXPECT_EQ(inner.size(), Code::kBlockCells);
  EXPECT_NE(Code::block(Code::of({8, 0, 8})), Code::block(Code::of({4, 0, 8})));
}

// ---- CellRange

TEST(CellRange, VisitsEveryCellItContainsOnce) {
  const Range2 block = range(2, 3, 4, 6);
  std::set<std::uint64_t> visited;
  block.for_each([&](std::uint64_t code) {
    EXPECT_TRUE(block.contains(CellCode<2>::coordinates(code)));
    EXPECT_TRUE(visited.insert(code).second);
  });
  EXPECT_EQ(static_cast<double>(visited.size()), block.count());
  EXPECT_EQ(block.count(), 12);
  for (const CellCoordinates<2>& beside : {CellCoordinates<2>{1, 3}, {5, 3}, {3, 2}, {3, 7}}) {
    EXPECT_FALSE(block.contains(beside));
  }
}

TEST(CellRange, SurroundsWhatIsNotAtItsBorder) {
  const Range2 block = range(2, 3, 4, 6);
  std::size_t surrounded = 0;
  block.for_each([&](std::uint64_t code) { surrounded += block.surrounds(CellCode<2>::coordinates(code)) ? 1 : 0; });
  EXPECT_EQ(surrounded, 2u);
  EXPECT_TRUE(block.surrounds({3, 4}));
  EXPECT_FALSE(block.surrounds({1, 4}));
}

TEST(CellRange, CountDoesNotOverflow) {
  constexpr std::uint32_t kLast = CellCode<3>::kLastCoordinate;
  const CellRange<3> all{{0, 0, 0, kLast, kLast, kLast}};
  EXPECT_EQ(all.count(), std::ldexp(1, 63));
}

TEST(CellRange, EqualMeansBothCornersAre) {
  EXPECT_EQ(range(1, 2, 3, 4), range(1, 2, 3, 4));
  for (std::size_t end = 0; end < 4; ++end) {
    Range2 other = range(1, 2, 3, 4);
    ++other.ends[end];
    EXPECT_FALSE(other == range(1, 2, 3, 4));
  }
}

// ---- GridSpec

TEST(GridSpec, ABoxIsInTheCellsOfItsCorners) {
  const Spec2 spec = four_by_four();
  EXPECT_EQ(spec.range(Box2({0, 0}, {9.5, 9.5})), range(0, 0, 0, 0));
  EXPECT_EQ(spec.range(Box2({5, 5}, {25, 12})), range(0, 0, 2, 1));
  EXPECT_EQ(spec.range(Box2({10, 20}, {10, 30})), range(1, 2, 1, 3));
}

TEST(GridSpec, BorderCellsReachToInfinity) {
  const Spec2 spec = four_by_four();
  EXPECT_EQ(spec.range(Box2({-1e30, -5}, {-1e29, -4})), range(0, 0, 0, 0));
  EXPECT_EQ(spec.range(Box2({1e30, 100}, {1e30, 1e300})), range(3, 3, 3, 3));
  EXPECT_EQ(spec.range(Box2({-kInfinity, 15}, {kInfinity, 15})), range(0, 1, 3, 1));
  EXPECT_EQ(spec.range(Box2({kInfinity, -kInfinity}, {kInfinity, -kInfinity})), range(3, 0, 3, 0));
}

TEST(GridSpec, OneCellTakesEverything) {
  const Spec2 spec;
  EXPECT_EQ(spec.cell_size(), kInfinity);
  EXPECT_EQ(spec.range(Box2({-kInfinity, 1e300}, {kInfinity, kInfinity})), range(0, 0, 0, 0));
}

TEST(GridSpec, UnlimitedGridsHaveRoomOnBothSidesOfTheOrigin) {
  const Spec2 spec = Spec2::unlimited(10, {1000, -1000});
  for (int axis = 0; axis < 2; ++axis) {
    const double origin = axis == 0 ? 1000 : -1000;
    EXPECT_EQ(spec.coordinate(axis, origin + 5) - spec.coordinate(axis, origin - 60'000 * 10.0 + 5), 60'000u);
    EXPECT_EQ(spec.coordinate(axis, origin + 1'000'000 * 10.0 + 5) - spec.coordinate(axis, origin + 5), 1'000'000u);
  }
}

/// All that a palette has, and what lies just beside cell borders.
template <class Scalar>
std::vector<Scalar> sorted_values(oracle::Palette palette, double origin, double size) {
  std::vector<Scalar> values = oracle::coordinates<Scalar>(palette);
  if constexpr (std::floating_point<Scalar>) {
    for (int i = -3; i < 40; ++i) {
      const auto border = static_cast<Scalar>(origin + i * size);
      if (!std::isfinite(border)) continue;
      for (const Scalar towards : {-std::numeric_limits<Scalar>::infinity(), std::numeric_limits<Scalar>::infinity()}) {
        values.push_back(std::nextafter(border, towards));
      }
      values.push_back(border);
    }
  }
  std::sort(values.begin(), values.end());
  return values;
}

// What everything rests on: in whatever way coordinates are rounded, boxes that overlap meet in a cell, and that cell
// holds the lower corner of their intersection.
template <class Scalar>
void expect_monotone(const GridSpec<Scalar, 1>& spec, const std::vector<Scalar>& values) {
  std::uint32_t before = 0;
  for (const Scalar value : values) {
    const std::uint32_t coordinate = spec.coordinate(0, value);
    ASSERT_LE(before, coordinate) << +value;
    ASSERT_LE(coordinate, CellCode<1>::kLastCoordinate);
    before = coordinate;
  }
}

// A box no wider than a cell is in few cells, whatever its place.
template <class Scalar>
void expect_narrow_boxes_in_few_cells(const GridSpec<Scalar, 1>& spec, const std::vector<Scalar>& values) {
  for (std::size_t i = 0; i < values.size(); i += 7) {
    for (std::size_t j = i; j < std::min(values.size(), i + 60); ++j) {
      const double width = static_cast<double>(values[j]) - static_cast<double>(values[i]);
      if (!(width <= spec.cell_size())) continue;
      ASSERT_LE(spec.coordinate(0, values[j]) - spec.coordinate(0, values[i]), 2u) << +values[i] << " " << +values[j];
    }
  }
}

template <class Scalar>
void expect_sound_specs() {
  for (const auto palette :
       {oracle::Palette::kFine, oracle::Palette::kLattice, oracle::Palette::kExtremes, oracle::Palette::kFar}) {
    for (const double size : {5e-324, 1e-320, 1e-40, 1e-3, 0.37, 1.0, 3.0, 1e3, 1e22, 1e36, 2e38, 1e100, 1.5e308}) {
      for (const double origin : {0.0, -50 * size, 17.3, 1e30, -1e30, -1.7e308}) {
        const auto values = sorted_values<Scalar>(palette, origin, size);
        const auto unlimited = GridSpec<Scalar, 1>::unlimited(size, {origin});
        expect_monotone<Scalar>(unlimited, values);
        expect_narrow_boxes_in_few_cells<Scalar>(unlimited, values);
        const GridSpec<Scalar, 1> limited(size, {origin}, {9});
        expect_monotone<Scalar>(limited, values);
        ASSERT_LE(limited.coordinate(0, values.back()), 9u);
      }
    }
  }
}

TEST(GridSpec, CoordinatesAreMonotoneAndNarrowBoxesInFewCellsAtEveryScale) {
  expect_sound_specs<float>();
  expect_sound_specs<double>();
  expect_sound_specs<std::int8_t>();
  expect_sound_specs<std::uint32_t>();
  expect_sound_specs<std::int64_t>();
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

Fit2 fit_for(double population) {
  Fit2 fit;
  fit.population = population;
  return fit;
}

/// Objects that the average object shares its cell with, itself included; by centre.
double crowding(const Fit2::Result& result, const std::vector<Box2>& boxes) {
  const Spec2 spec = Spec2::unlimited(result.cell_size, result.lower);
  std::map<std::uint64_t, double> cells;
  for (const Box2& box : boxes) {
    const double x = (box.min[0] + box.max[0]) / 2;
    const double y = (box.min[1] + box.max[1]) / 2;
    cells[CellCode<2>::of({spec.coordinate(0, x), spec.coordinate(1, y)})] += 1;
  }
  double sum = 0;
  for (const auto& [cell, objects] : cells) sum += objects * objects;
  return sum / static_cast<double>(boxes.size());
}

TEST(GridFit, AimsAtTheWantedPopulation) {
  const auto boxes = uniform_boxes(8000, 1000, 0.1);
  for (const int population : {5, 48, 300}) {
    const auto result = fit_for(population).derive(boxes, boxes.size());
    EXPECT_GT(crowding(result, boxes), population * 0.5) << population;
    EXPECT_LT(crowding(result, boxes), population * 2.0 + 2) << population;
  }
}

TEST(GridFit, WithoutAPopulationCellsHoldSomeButNotMany) {
  const auto boxes = uniform_boxes(8000, 1000, 0.1);
  const auto result = Fit2{}.derive(boxes, boxes.size());
  EXPECT_GT(crowding(result, boxes), 1.2);
  EXPECT_LT(crowding(result, boxes), 100);
  EXPECT_GE(result.met, 1);
  EXPECT_LT(result.met, 200);
}

TEST(GridFit, AThinnerSampleGivesTheSameCells) {
  const auto boxes = uniform_boxes(20'000, 1000, 0.1);
  std::vector<Box2> sample;
  for (std::size_t i = 0; i < boxes.size(); i += 10) sample.push_back(boxes[i]);
  const double size = fit_for(20).derive(boxes, boxes.size()).cell_size;
  EXPECT_NEAR(fit_for(20).derive(sample, boxes.size()).cell_size, size, 0.15 * size);
}

TEST(GridFit, CellsAreWiderThanMostBoxes) {
  const auto boxes = uniform_boxes(5000, 1000, 120);
  EXPECT_GE(fit_for(1).derive(boxes, boxes.size()).cell_size, 120);
}

TEST(GridFit, AFewObjectsFarAwayDoNotStretchTheGrid) {
  auto boxes = uniform_boxes(3000, 100, 0.5);
  const double near = Fit2{}.derive(boxes, boxes.size()).cell_size;
  for (int i = 0; i < 5; ++i) boxes[static_cast<std::size_t>(600 * i)] = Box2({1e12, -1e12}, {1e12, 1e12});
  EXPECT_LT(Fit2{}.derive(boxes, boxes.size()).cell_size, 2 * near);
}

TEST(GridFit, InfiniteBoxesDoNotCount) {
  auto boxes = uniform_boxes(1000, 100, 0.5);
  const double finite = Fit2{}.derive(boxes, boxes.size()).cell_size;
  boxes.push_back(Box2({-kInfinity, -1}, {kInfinity, 0}));
  boxes.push_back(Box2({-kInfinity, -kInfinity}, {kInfinity, 0}));
  EXPECT_NEAR(Fit2{}.derive(boxes, boxes.size()).cell_size, finite, 0.1 * finite);
}

TEST(GridFit, NothingToGoByStillGivesCells) {
  for (const std::vector<Box2>& boxes : {std::vector<Box2>{},
                                         {Box2({3, 3}, {3, 3})},
                                         {Box2({-kInfinity, 0}, {kInfinity, 1})},
                                         {Box2({-1e308, 0}, {-1e308, 1}), Box2({1.7e308, 0}, {1.7e308, 1})}}) {
    const auto result = Fit2{}.derive(boxes, boxes.size());
    EXPECT_GT(result.cell_size, 0);
    EXPECT_TRUE(std::isfinite(result.cell_size));
    EXPECT_EQ(result.lower, result.upper);
  }
}

TEST(GridFit, CellsFollowTheScale) {
  for (const double unit : {5e-324, 1e-310, 1e-300, 1e-200, 1e-160, 1e-100, 1.0, 1e100, 1e160, 1e200, 1e300}) {
    for (const double width : {0.0, 1.0}) {
      std::vector<Box2> boxes;
      for (int i = 0; i < 10; ++i) boxes.push_back(Box2({i * unit, 0}, {(i + width) * unit, unit}));
      const auto result = fit_for(1).derive(boxes, boxes.size());
      ASSERT_GT(result.cell_size, 0) << unit;
      if (unit < 1e-300) continue;  // in one cell, for all that is known
      EXPECT_GE(result.cell_size, 0.1 * unit) << unit;
      EXPECT_LE(result.cell_size, 10 * unit) << unit;
      const Spec2 spec = Spec2::unlimited(result.cell_size, result.lower);
      EXPECT_LT(spec.range(boxes.front()).last(0), spec.range(boxes.back()).first(0)) << unit;
    }
  }
}

TEST(GridFit, KeepsAGivenSize) {
  const auto boxes = uniform_boxes(100, 100, 1);
  Fit2 fit;
  for (const double size : {7.0, 1e-300, 1e300}) {
    fit.cell_size = size;
    EXPECT_EQ(fit.derive(boxes, 100).cell_size, size);
  }
}

TEST(GridFit, BoundedGridsHaveNoMoreCellsThanAllowed) {
  const auto boxes = uniform_boxes(100, 100, 1);
  Fit2 fit;
  fit.cell_size = 1e-300;
  const auto result = fit.derive(boxes, 100);
  for (const double cells : {1.0, 100.0, 1e6}) {
    const Spec2 spec = Fit2::bounded(result, cells);
    const double all = spec.range(Box2({-kInfinity, -kInfinity}, {kInfinity, kInfinity})).count();
    EXPECT_LE(all, cells);
    EXPECT_GE(all, cells / 8);
  }
}

TEST(GridFit, TellsHowMuchOfItIsWhereAnotherWas) {
  Fit2::Result here;
  here.upper = {10, 10};
  Fit2::Result there = here;
  EXPECT_EQ(here.share_within(there), 1);
  there.lower[0] = 5, there.upper[0] = 15;
  EXPECT_EQ(here.share_within(there), 0.5);
  there.lower[1] = 20, there.upper[1] = 30;
  EXPECT_EQ(here.share_within(there), 0);
  const Fit2::Result point;
  EXPECT_EQ(point.share_within(here), 1);
  EXPECT_EQ(point.share_within(there), 0);
}

}  // namespace
}  // namespace sweepgrid::grid_spec_test
