// Which grid a box lives in, and which grids there are.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

#include <sweepgrid/grid/levels.hpp>
#include <sweepgrid/grid/levels.inl.hpp>

#include "grid_client.hpp"

namespace sweepgrid::levels_test {
namespace {

using Levels2 = Levels<double, 2>;
using Box2 = Box<double, 2>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double size_of(const Levels2& levels, GridIndex grid) { return levels.grid(grid).spec().cell_size(); }

/// A home that is as fine as it ever gets: asked for, made, asked for again.
GridIndex finest_home(Levels2& levels, double width) {
  levels.make_room(width);
  static_cast<void>(levels.home(width));
  levels.make_room(width);
  return levels.home(width);
}

/// Puts one object of that width into the grid.
void occupy(Levels2& levels, GridIndex grid, ObjectId object, double width) {
  oracle::ClientBoxes<double, 2> boxes;
  boxes[object].after = Box2({0, 0}, {width, 0});
  levels.grid(grid).begin_step(1);
  levels.grid(grid).route_insert(0, object, *boxes[object].after);
  oracle::finish_step(levels.grid(grid), boxes);
}

class LevelsTest : public ::testing::Test {
 protected:
  LevelsTest() { levels_.start_family(1, {0, 0}, {CellKind::kRows}, 1); }

  Levels2 levels_;
};

TEST_F(LevelsTest, WidthIsThatOfTheLongestEdge) {
  EXPECT_EQ(Levels2::width(Box2({1, 1}, {3, 8})), 7);
  EXPECT_EQ(Levels2::width(Box2({1, 1}, {1, 1})), 0);
  EXPECT_EQ(Levels2::width(Box2({-kInfinity, 0}, {0, 0})), kInfinity);
  EXPECT_EQ(Levels2::width(Box2({-kInfinity, 0}, {kInfinity, 0})), kInfinity);
  EXPECT_EQ(Levels2::width(Box2({-1e308, 0}, {1e308, 0})), kInfinity);
  EXPECT_EQ(Levels2::width(Box2({kInfinity, 0}, {kInfinity, 2})), 2);
  using LevelsInt = Levels<std::int32_t, 1>;
  EXPECT_EQ(LevelsInt::width(Box<std::int32_t, 1>({std::numeric_limits<std::int32_t>::min()},
                                                  {std::numeric_limits<std::int32_t>::max()})),
            4294967295.0);
}

TEST_F(LevelsTest, HomeIsTheFinestGridWhoseCellsAreAsWide) {
  for (const auto& [width, size] : std::vector<std::pair<double, double>>{
           {0, 1}, {1, 1}, {1.001, 4}, {4, 4}, {5, 16}, {16, 16}, {17, 64}, {1000, 1024}, {1e8, 67108864.0 * 4}}) {
    EXPECT_EQ(size_of(levels_, finest_home(levels_, width)), size) << width;
  }
  for (const double width : {1e9, 1e300, kInfinity}) {
    EXPECT_EQ(size_of(levels_, finest_home(levels_, width)), kInfinity) << width;
  }
  for (const double width : {0.0, 1.0, 3.0, 900.0, 1e8, kInfinity}) {
    const GridIndex home = levels_.home(width);
    for (const GridIndex grid : levels_.live()) {
      EXPECT_EQ(levels_.holds(grid, width), !levels_.coarser(home, grid)) << width;
    }
  }
}

TEST_F(LevelsTest, ALevelIsMadeWhenItWasAskedForAndUntilThenACoarserOneServes) {
  EXPECT_TRUE(levels_.make_room(100));
  EXPECT_EQ(levels_.live().size(), 2u);
  EXPECT_EQ(size_of(levels_, levels_.home(3)), 256);
  EXPECT_EQ(levels_.live().size(), 2u);
  EXPECT_TRUE(levels_.make_room(100));
  EXPECT_EQ(levels_.live().size(), 3u);
  EXPECT_EQ(size_of(levels_, levels_.home(3)), 4);
  EXPECT_FALSE(levels_.make_room(100));
}

TEST_F(LevelsTest, ThereIsRoomForTheWidestAndNothingIsMadeTwice) {
  for (const double widest : {0.5, 20.0, 7.0, 1e12, kInfinity, 3.0}) {
    levels_.make_room(widest);
    EXPECT_GE(size_of(levels_, levels_.home(widest)), widest);
  }
  std::set<double> sizes;
  for (const GridIndex grid : levels_.live()) sizes.insert(size_of(levels_, grid));
  EXPECT_EQ(sizes.size(), levels_.live().size());
}

TEST_F(LevelsTest, EmptyGridsAreDroppedButForTheFinest) {
  const GridIndex wide = finest_home(levels_, 60);
  finest_home(levels_, 1000);
  finest_home(levels_, kInfinity);
  occupy(levels_, wide, 1, 60);
  EXPECT_EQ(levels_.live().size(), 4u);
  EXPECT_EQ(levels_.drop_empty(), 64);
  EXPECT_EQ(levels_.live(), (std::vector<GridIndex>{levels_.finest(), wide}));
  EXPECT_EQ(levels_.home(60), wide);
  EXPECT_TRUE(levels_.make_room(kInfinity));
  EXPECT_EQ(size_of(levels_, levels_.home(kInfinity)), kInfinity);
}

TEST_F(LevelsTest, ANewFamilyDropsTheOldOne) {
  occupy(levels_, finest_home(levels_, 60), 1, 60);
  levels_.start_family(0.25, {5, 5}, {CellKind::kRows}, 2);
  EXPECT_EQ(levels_.cell_size(), 0.25);
  EXPECT_EQ(levels_.grid(levels_.finest()).shards(), 2u);
  EXPECT_EQ(levels_.live(), (std::vector<GridIndex>{levels_.finest()}));
  const GridIndex wide = finest_home(levels_, 60);
  EXPECT_EQ(size_of(levels_, wide), 64);
  EXPECT_EQ(levels_.home(60), wide);
  EXPECT_FALSE(levels_.make_room(60));
}

TEST_F(LevelsTest, CoarserIsAStrictTotalOrder) {
  finest_home(levels_, 60);
  finest_home(levels_, 5);
  finest_home(levels_, kInfinity);
  const auto& live = levels_.live();
  ASSERT_EQ(live.size(), 4u);
  for (const GridIndex a : live) {
    EXPECT_FALSE(levels_.coarser(a, a));
    for (const GridIndex b : live) {
      if (a != b) {
        EXPECT_NE(levels_.coarser(a, b), levels_.coarser(b, a));
      }
      if (levels_.coarser(a, b)) {
        EXPECT_GE(size_of(levels_, a), size_of(levels_, b));
      }
      for (const GridIndex c : live) {
        if (levels_.coarser(a, b) && levels_.coarser(b, c)) {
          EXPECT_TRUE(levels_.coarser(a, c));
        }
      }
    }
  }
}

TEST_F(LevelsTest, ASingleGridIsEverybodysHome) {
  finest_home(levels_, 60);
  levels_.start_single(GridSpec<double, 2>(7, {0, 0}, {9, 9}), {CellKind::kRows}, 1);
  EXPECT_EQ(levels_.live().size(), 1u);
  for (const double width : {0.0, 5.0, 1e9, kInfinity}) {
    EXPECT_EQ(levels_.home(width), levels_.finest());
    EXPECT_TRUE(levels_.holds(levels_.finest(), width));
  }
  EXPECT_FALSE(levels_.make_room(kInfinity));
}

}  // namespace
}  // namespace sweepgrid::levels_test
