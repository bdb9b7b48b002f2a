// Of all cells that may see a pair, exactly one reports what became of it.
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <vector>

#include <sweepgrid/engine/object_table.hpp>
#include <sweepgrid/engine/reporter.hpp>
#include <sweepgrid/grid/levels.inl.hpp>
#include <sweepgrid/sap/cell_kind.inl.hpp>

#include "op_script.hpp"

namespace sweepgrid::reporter_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint64_t kStep = 7;

/// Two objects in random grids with random pasts, and what every cell says of them.
template <class Scalar, int Dim>
class PairPlay {
 public:
  using BoxType = Box<Scalar, Dim>;
  using Objects = ObjectTable<Scalar, Dim>;
  using Range = CellRange<Dim>;

  explicit PairPlay(std::uint64_t seed) : random_(seed) {
    // Two families, as while objects move from one to the other, and two grids of the same cell size.
    levels_.start_family(2, any_origin(), {CellKind::kRows}, 1);
    levels_.make_room(kInfinity);
    levels_.make_room(8);
    levels_.start_family(seed % 3 == 0 ? 2 : 0.75, any_origin(), {CellKind::kRows}, 1);
    levels_.make_room(kInfinity);
    levels_.make_room(3);
    for (auto& object : objects_) object = table_.insert(any_box()).index;
  }

  /// Returns whether the pair changed; fails unless one cell that hears of it reports that, and no other says anything.
  bool expect_one_reporter() {
    for (const ObjectId object : objects_) choose(table_.record(object));
    const Side a = side(objects_[0]);
    const Side b = side(objects_[1]);
    const bool was = a.was && b.was && a.before.overlaps(b.before);
    const bool is = a.is && b.is && a.after.overlaps(b.after);
    const Reporter<Scalar, Dim> reporter(table_, levels_, kStep);
    std::size_t reports = 0;
    for (const GridIndex grid : levels_.live()) {
      for (const std::uint64_t cell : cells_near(grid, a, b)) {
        const Verdict verdict = reporter.judge(PairKey(objects_[0], objects_[1]), grid, cell);
        if (verdict == Verdict::kNothing) continue;
        ++reports;
        EXPECT_EQ(verdict, is ? Verdict::kBegin : Verdict::kEnd);
        EXPECT_NE(was, is);
        EXPECT_TRUE(hear(grid, CellCode<Dim>::coordinates(cell), a, b, was))
            << "grid " << int{grid} << " does not hear of the pair";
      }
    }
    EXPECT_EQ(reports, was == is ? 0u : 1u);
    return was != is;
  }

 private:
  struct Side {
    bool changed, was, is;
    BoxType before, after;
    GridIndex grid_before, grid;
  };

  std::array<double, Dim> any_origin() {
    std::array<double, Dim> origin;
    for (double& o : origin) o = random_.between(-5, 5) / 3.0;
    return origin;
  }

  BoxType any_box() {
    BoxType box;
    for (int axis = 0; axis < Dim; ++axis) {
      const double low = random_.between(-8, 8) / 2.0;
      box.min[axis] = static_cast<Scalar>(low);
      box.max[axis] = static_cast<Scalar>(low + random_.below(8) / 2.0 * (random_.percent(20) ? 4 : 1));
    }
    return box;
  }

  // Any past of an object: it rests, or it came, went, moved, or moved to another grid.
  void choose(typename Objects::Record& record) {
    const auto& live = levels_.live();
    const auto any_grid = [&] { return live[static_cast<std::size_t>(random_.below(static_cast<int>(live.size())))]; };
    record.box = any_box();
    record.grid = any_grid();
    if (random_.percent(30)) {
      record.changed_at = kStep - 1;
      record.change = Objects::kLive | Objects::kInserted;
      return;
    }
    record.changed_at = kStep;
    const int what = random_.below(6);
    record.change = Objects::kLive | (what == 0   ? Objects::kInserted
                                      : what == 1 ? Objects::kErased | Objects::kUpdated
                                                  : Objects::kUpdated);
    record.before = any_box();
    record.grid_before = what == 2 ? any_grid() : record.grid;
    if (what < 4) return;
    record.before = record.box;  // a little, so that most pairs go on
    record.box.max[0] += static_cast<Scalar>(random_.below(3));
  }

  Side side(ObjectId object) {
    const auto& record = table_.record(object);
    const bool changed = record.changed_at == kStep;
    Side side{changed,    true,
              true,       changed ? record.before : record.box,
              record.box, changed ? record.grid_before : record.grid,
              record.grid};
    if (changed) side.was = (record.change & Objects::kInserted) == 0;
    if (changed) side.is = (record.change & Objects::kErased) == 0;
    return side;
  }

  [[nodiscard]] Range range(GridIndex grid, const BoxType& box) const { return levels_.grid(grid).spec().range(box); }

  std::set<std::uint64_t> cells_near(GridIndex grid, const Side& a, const Side& b) const {
    std::set<std::uint64_t> cells;
    for (const Side* side : {&a, &b}) {
      for (const BoxType* box : {&side->before, &side->after}) {
        range(grid, *box).for_each([&](std::uint64_t cell) { cells.insert(cell); });
      }
    }
    return cells;
  }

  // Whether the object lives in the cell, at the start of the step or at its end.
  [[nodiscard]] bool lives(const Side& a, GridIndex grid, const CellCoordinates<Dim>& cell, bool start) const {
    if (!(start ? a.was : a.is) || grid != (start ? a.grid_before : a.grid)) return false;
    return range(grid, start ? a.before : a.after).contains(cell);
  }

  // Whether the object is shown to the cell, where it does not live: to coarser grids for everybody, to finer ones for
  // those that rest, and there not in cells that it covers before and after.
  [[nodiscard]] bool visits(const Side& a, GridIndex grid, const CellCoordinates<Dim>& cell, const Side& other,
                            bool start) const {
    const GridIndex home = start ? a.grid_before : a.grid;
    if (!a.changed || grid == home || !(start ? a.was : a.is)) return false;
    const bool moved_house = a.was && a.is && a.grid_before != a.grid;  // then the sides are shown apart
    const Range at_start = range(grid, a.was && !(moved_house && !start) ? a.before : a.after);
    const Range at_end = range(grid, a.is && !(moved_house && start) ? a.after : a.before);
    if (!at_start.contains(cell) && !at_end.contains(cell)) return false;
    if (levels_.coarser(grid, home)) return true;
    const bool both = a.was && a.is && !moved_house;
    return !other.changed && !(both && at_start.surrounds(cell) && at_end.surrounds(cell));
  }

  [[nodiscard]] bool hear(GridIndex grid, const CellCoordinates<Dim>& cell, const Side& a, const Side& b,
                          bool start) const {
    const bool a_lives = lives(a, grid, cell, start);
    const bool b_lives = lives(b, grid, cell, start);
    return (a_lives && b_lives) || (a_lives && visits(b, grid, cell, a, start)) ||
           (b_lives && visits(a, grid, cell, b, start));
  }

  oracle::Random random_;
  Levels<Scalar, Dim> levels_;
  Objects table_;
  std::array<ObjectId, 2> objects_{};
};

template <class Scalar, int Dim>
void expect_one_reporter_for_many_pairs() {
  int changed = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    PairPlay<Scalar, Dim> play(seed);
    for (int pair = 0; pair < 200 && !::testing::Test::HasFailure(); ++pair) {
      changed += play.expect_one_reporter() ? 1 : 0;
    }
  }
  EXPECT_GT(changed, 1000);
}

TEST(Reporter, ExactlyOneCellThatHearsOfAPairReportsItsChange) {
  expect_one_reporter_for_many_pairs<float, 2>();
  expect_one_reporter_for_many_pairs<double, 3>();
  expect_one_reporter_for_many_pairs<std::int32_t, 1>();
}

TEST(Reporter, TheCornerIsInTheRangesOfBothBoxes) {
  oracle::Random random(1);
  const auto values = oracle::coordinates<float>(oracle::Palette::kExtremes);
  const auto any = [&] { return values[static_cast<std::size_t>(random.below(static_cast<int>(values.size())))]; };
  for (const double size : {1e-40, 1.0, 1e30}) {
    const auto spec = GridSpec<float, 1>::unlimited(size, {0});
    for (int i = 0; i < 3000; ++i) {
      Box<float, 1> a({any()}, {any()});
      Box<float, 1> b({any()}, {any()});
      if (!a.valid() || !b.valid() || !a.overlaps(b)) continue;
      const auto cell = CellCode<1>::coordinates(Reporter<float, 1>::corner(a, b, spec));
      EXPECT_TRUE(spec.range(a).contains(cell) && spec.range(b).contains(cell));
    }
  }
}

}  // namespace
}  // namespace sweepgrid::reporter_test
