// The cells that exist, the calls on their way to them, and what one grid makes of a step.
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <sweepgrid/grid/cell_directory.hpp>
#include <sweepgrid/grid/grid.hpp>
#include <sweepgrid/grid/op_queues.hpp>
#include <sweepgrid/sap/cell_kind.inl.hpp>

#include "grid_client.hpp"
#include "op_script.hpp"

namespace sweepgrid::grid_test {
namespace {

using Box2 = Box<double, 2>;
using Spec2 = GridSpec<double, 2>;
using Grid2 = Grid<double, 2>;
using Boxes2 = oracle::ClientBoxes<double, 2>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// ---- CellDirectory

/// Random cells of `side`^2 come and go: few blocks and many, growing and shrinking.
void expect_directory_is_a_map(std::uint32_t side, std::uint64_t seed) {
  CellDirectory<2> directory;
  std::unordered_map<std::uint64_t, std::uint32_t> map;
  oracle::Random random(seed);
  for (std::uint32_t call = 0; call < 20'000; ++call) {
    const auto axis = [&] { return static_cast<std::uint32_t>(random.below(static_cast<int>(side))) * 5; };
    const std::uint64_t code = CellCode<2>::of({axis(), axis()});
    const auto known = map.find(code);
    ASSERT_EQ(directory.find(code), known == map.end() ? CellDirectory<2>::kAbsent : known->second);
    const bool growing = call / 4000 % 2 == 0;
    if (known == map.end() && random.percent(growing ? 90 : 10)) {
      auto& place = directory.place(code);
      ASSERT_EQ(place, CellDirectory<2>::kAbsent);
      place = call;
      directory.added(code);
      map.emplace(code, call);
    } else if (known != map.end() && random.percent(growing ? 10 : 90)) {
      directory.erase(code);
      map.erase(known);
    }
    ASSERT_EQ(directory.size(), map.size());
    const auto* block = directory.find_block(CellCode<2>::block(code));
    ASSERT_EQ(block == nullptr ? CellDirectory<2>::kAbsent : block[CellCode<2>::inner(code)], directory.find(code));
    if (call % 1000 != 0) continue;
    std::set<std::uint64_t> visited;
    directory.for_each([&](std::uint64_t cell) { ASSERT_TRUE(map.contains(cell) && visited.insert(cell).second); });
    ASSERT_EQ(visited.size(), map.size());
  }
}

TEST(CellDirectory, IsAMapFromCodesToIds) {
  for (const std::uint32_t side : {2U, 6U, 20U, 60U, 400'000U}) expect_directory_is_a_map(side, side);
}

TEST(CellDirectory, SpaceWithoutCellsTakesNoMemory) {
  CellDirectory<3> directory;
  EXPECT_EQ(directory.bytes(), 0u);
  for (std::uint32_t x = 0; x < 4000; x += 4) {
    const std::uint64_t code = CellCode<3>::of({x, 0, 0});
    directory.place(code) = x;
    directory.added(code);
  }
  const std::size_t most = directory.bytes();
  EXPECT_LT(most, 1000 * 400u);
  for (std::uint32_t x = 0; x < 4000; x += 4) directory.erase(CellCode<3>::of({x, 0, 0}));
  EXPECT_EQ(directory.size(), 0u);
  EXPECT_LT(directory.bytes(), most / 100);
  EXPECT_EQ(directory.find_block(0), nullptr);
}

// ---- OpQueues

TEST(OpQueues, KeepCallsByBlockAndShardInOrder) {
  OpQueues queues;
  queues.reset(2, 4);
  EXPECT_EQ(queues.blocks(), 2u);
  for (ObjectId object = 0; object < 16; ++object) {
    auto& list = queues.list(object % 2, object % 4);
    if (object < 8) {
      list.known.push_back({object, static_cast<std::uint32_t>(CellCall::kErase), object});
    } else {
      list.fresh.push_back({~std::uint64_t{object}, object, CellCall::kInsert});
    }
  }
  EXPECT_EQ(queues.written(0), 8u);
  for (std::size_t block = 0; block < 2; ++block) {
    for (ObjectId shard = 0; shard < 4; ++shard) {
      const auto& list = queues.list(block, shard);
      ASSERT_EQ(list.size(), shard % 2 == block ? 4u : 0u);
      for (ObjectId i = 0; i < list.size() / 2; ++i) {
        EXPECT_EQ(list.known[i].object, shard + 4 * i);
        EXPECT_EQ(static_cast<CellCall>(list.known[i].call), CellCall::kErase);
        EXPECT_EQ(list.fresh[i].object, 8 + shard + 4 * i);
        EXPECT_EQ(list.fresh[i].cell, ~std::uint64_t{8 + shard + 4 * i});
      }
    }
  }
  queues.note_step(0);
  EXPECT_EQ(queues.written(0), 4u);
  EXPECT_EQ(queues.list(0, 0).size(), 0u);
  EXPECT_EQ(queues.written(1), 8u);
  queues.pass(1);
  EXPECT_EQ(queues.written(0) + queues.written(1), 0u);
}

TEST(OpQueues, RefuseMoreCallsThanTheyCanCount) {
  EXPECT_NO_THROW(OpQueues::require_countable(0xffffffffU));
  EXPECT_THROW(OpQueues::require_countable(0x100000000U), std::length_error);
}

TEST(OpQueues, ReturnMemoryThatTheLatest64StepsDidNotUse) {
  OpQueues queues;
  queues.reset(1, 1);
  queues.list(0, 0).known.resize(100'000);
  for (int step = 0; step < 64; ++step) {
    queues.note_step(0);
    EXPECT_GE(queues.bytes(), 100'000 * sizeof(OpQueues::Known));
    queues.list(0, 0).known.resize(10);
  }
  queues.note_step(0);
  EXPECT_LT(queues.bytes(), 1000u);
  queues.list(0, 0).fresh.resize(100'000);
  queues.note_step(0);
  queues.pass(63);
  EXPECT_GE(queues.bytes(), 100'000 * sizeof(OpQueues::Fresh));
  queues.pass(1);
  EXPECT_LT(queues.bytes(), 1000u);
}

// ---- Grid

/// Objects in a grid of their own and visitors from elsewhere, who all do something at random; and what the grid should
/// tell of it, from first principles.
class GridPlay {
 public:
  GridPlay(const Spec2& spec, CellKind kind, std::size_t shards, bool wide, std::uint64_t seed)
      : grid_(spec, {kind, 4}, shards), random_(seed), wide_(wide) {}

  /// Returns what was wrong.
  std::string step(std::size_t blocks, int moving_percent) {
    boxes_.settle();
    resident_.clear();
    visitor_.clear();
    grid_.begin_step(blocks);
    for (ObjectId object = 0; object < kObjects; ++object) {
      if (here_.contains(object)) {
        act(object, object % blocks, moving_percent);
      } else {
        come_by(object, object % blocks);
      }
    }
    const oracle::CellSums sums = oracle::finish_step(grid_, boxes_, blocks);
    for (const ObjectId object : resident_)
      boxes_[object].after ? here_.insert(object).second : here_.erase(object) > 0;
    const std::string wrong = compare(sums);
    return wrong.empty() ? compare_homes() : wrong;
  }

  /// Has objects live in the grid without a word about their pairs. To be called first. Returns what was wrong.
  std::string fill(std::size_t blocks) {
    grid_.begin_step(blocks);
    for (ObjectId object = 0; object < kObjects / 2; ++object) {
      boxes_[object].after = any_box(wide_);
      grid_.route_insert(object % blocks, object, *boxes_[object].after);
      here_.insert(object);
    }
    for (std::size_t block = 0; block < blocks; ++block) grid_.end_block(block);
    for (std::size_t shard = 0; shard < grid_.shards(); ++shard) {
      DrainOutput<double, 2> out;
      grid_.fill(
          shard, [this](ObjectId object) -> const Box2& { return boxes_.after(object); }, out);
      if (!out.deltas.empty()) return "filling changes pairs";
    }
    return compare_homes();
  }

  [[nodiscard]] const Grid2& grid() const { return grid_; }
  [[nodiscard]] std::size_t changes() const { return changes_; }

 private:
  static constexpr ObjectId kObjects = 90;

  [[nodiscard]] static bool resting_only(ObjectId visitor) { return visitor % 2 == 0; }
  Box2 any_box(bool may_be_wide) {
    Box2 box;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      box.min[axis] = random_.between(-8, 40) * 2;
      box.max[axis] = box.min[axis] + random_.below(8) * 2;
      if (!may_be_wide || random_.percent(85)) continue;
      box.min[axis] = random_.percent(50) ? -kInfinity : -30;
      box.max[axis] = random_.percent(50) ? kInfinity : 70;
    }
    return box;
  }

  // A resident rests, moves or goes.
  void act(ObjectId object, std::size_t block, int moving_percent) {
    auto& boxes = boxes_[object];
    resident_.insert(object);
    if (random_.percent(8)) {
      boxes.after.reset();
      grid_.route_erase(block, object, *boxes.before);
    } else if (random_.percent(moving_percent)) {
      boxes.after = any_box(wide_);
      if (random_.percent(50)) {
        boxes.after = *boxes.before;
        boxes.after->max[1] += random_.below(3);
      }
      if (boxes.after == boxes.before) return;
      const bool migrates = grid_.route_update(block, object, *boxes.before, *boxes.after);
      EXPECT_EQ(migrates, !(grid_.spec().range(*boxes.before) == grid_.spec().range(*boxes.after)));
    }
  }

  // A stranger becomes a resident, or stays one that comes, changes or goes elsewhere.
  void come_by(ObjectId object, std::size_t block) {
    auto& boxes = boxes_[object];
    if (!boxes.before && random_.percent(50)) {
      boxes.after = any_box(wide_);
      resident_.insert(object);
      grid_.route_insert(block, object, *boxes.after);
      return;
    }
    if (random_.percent(40)) return;
    boxes.after = any_box(wide_ || resting_only(object));
    if (boxes.before && random_.percent(30)) boxes.after.reset();
    if (boxes.after == boxes.before) return;
    visitor_.insert(object);
    grid_.route_visit(block, object, boxes.before ? &*boxes.before : nullptr, boxes.after ? &*boxes.after : nullptr,
                      resting_only(object));
  }

  [[nodiscard]] std::set<std::uint64_t> cells(const std::optional<Box2>& box) const {
    return box ? oracle::cells_of(grid_.spec(), *box) : std::set<std::uint64_t>{};
  }

  // Adds how the pair changes in the cells where the resident is; a visitor meets it in any of them.
  void expect(oracle::CellSums& sums, ObjectId resident, ObjectId other, bool visits) {
    const auto& a = boxes_[resident];
    const auto& b = boxes_[other];
    const auto other_before = cells(visits ? std::nullopt : b.before);
    const auto other_after = cells(visits ? std::nullopt : b.after);
    const auto hears = [&](const std::set<std::uint64_t>& other_cells, std::uint64_t code) {
      if (!visits) return other_cells.contains(code);
      const auto cell = CellCode<2>::coordinates(code);
      return (b.before && grid_.spec().range(*b.before).contains(cell)) ||
             (b.after && grid_.spec().range(*b.after).contains(cell));
    };
    for (const std::uint64_t code : cells(a.before)) {
      if (b.before && a.before->overlaps(*b.before) && hears(other_before, code)) --sums[{code, {resident, other}}];
    }
    for (const std::uint64_t code : cells(a.after)) {
      if (b.after && a.after->overlaps(*b.after) && hears(other_after, code)) ++sums[{code, {resident, other}}];
    }
  }

  std::string compare(oracle::CellSums sums) {
    oracle::CellSums expected;
    for (const ObjectId a : resident_) {
      for (const ObjectId b : resident_) {
        if (a < b) expect(expected, a, b, false);
      }
      for (const ObjectId b : visitor_) expect(expected, a, b, true);
    }
    // Some visitors are for those that rest; what the others hear of them does not matter.
    const auto idle = [&](const auto& entry) {
      const PairKey pair = entry.first.second;
      const bool first_visits = visitor_.contains(pair.lower());
      const ObjectId visitor = first_visits ? pair.lower() : pair.upper();
      const ObjectId resident = first_visits ? pair.upper() : pair.lower();
      return entry.second == 0 || (visitor_.contains(visitor) && resting_only(visitor) && boxes_.changed(resident));
    };
    std::erase_if(expected, idle);
    std::erase_if(sums, idle);
    changes_ += expected.size();
    if (expected == sums) return {};
    return std::to_string(sums.size()) + " changes instead of " + std::to_string(expected.size());
  }

  std::string compare_homes() {
    std::string wrong;
    const auto homes = oracle::homes<double, 2>(grid_, [&](const auto& resident) {
      if (!here_.contains(resident.object)) wrong = "a ghost";
      if (!(resident.box == OrderedBox<double, 2>(boxes_.after(resident.object)))) wrong = "a wrong box";
    });
    if (!wrong.empty()) return wrong;
    for (const ObjectId object : here_) {
      const auto found = homes.find(object);
      if (found == homes.end() || found->second != cells(boxes_[object].after)) return "a wrong home";
    }
    grid_.for_each_cell([&](const auto& cell) {
      if (cell.size() == 0 || grid_.find(cell.code()) != &cell) wrong = "a cell is empty or not found";
    });
    return wrong;
  }

  Grid2 grid_;
  oracle::Random random_;
  bool wide_;
  Boxes2 boxes_;
  std::set<ObjectId> here_;      // live in the grid
  std::set<ObjectId> resident_;  // in this step
  std::set<ObjectId> visitor_;
  std::size_t changes_ = 0;
};

TEST(Grid, TellsEveryCellExactlyWhatChangesThere) {
  std::uint64_t seed = 0;
  for (const CellKind kind : {CellKind::kRows, CellKind::kBatch, CellKind::kSegmented}) {
    for (const std::size_t shards : {1, 8}) {
      for (const bool limited : {true, false}) {
        const Spec2 spec = limited ? Spec2(10, {0, 0}, {5, 3}) : Spec2::unlimited(10, {0, 0});
        GridPlay play(spec, kind, shards, limited, ++seed);
        if (seed % 2 == 0) {
          ASSERT_EQ(play.fill(1 + seed % 3), "") << "kind " << static_cast<int>(kind);
        }
        for (std::size_t step = 0; step < 30; ++step) {
          ASSERT_EQ(play.step(1 + step % 4, step % 3 == 1 ? 90 : 20), "")
              << "kind " << static_cast<int>(kind) << ", " << shards << " shards, step " << step;
        }
        EXPECT_GT(play.changes(), 1000u);
        EXPECT_GT(play.grid().cell_count(), 0u);
        EXPECT_GT(play.grid().cell_bytes(), 0u);
        EXPECT_GT(play.grid().queue_bytes(), 0u);
      }
    }
  }
}

/// One shard, one block.
class SmallGrid : public ::testing::Test {
 protected:
  void begin() {
    boxes_.settle();
    grid_.begin_step(1);
  }
  void insert(ObjectId object, const Box2& box) {
    boxes_[object].after = box;
    grid_.route_insert(0, object, box);
  }
  void update(ObjectId object, const Box2& box) {
    boxes_[object].after = box;
    grid_.route_update(0, object, *boxes_[object].before, box);
  }
  void erase(ObjectId object) {
    boxes_[object].after.reset();
    grid_.route_erase(0, object, *boxes_[object].before);
  }
  oracle::CellSums end() { return oracle::finish_step(grid_, boxes_); }

  Grid2 grid_{Spec2(10, {0, 0}, {3, 3}), {CellKind::kRows}, 1};
  Boxes2 boxes_;
};

TEST_F(SmallGrid, OnlyCellsWithCallsAreActive) {
  begin();
  insert(1, Box2({35, 35}, {36, 36}));
  insert(2, Box2({5, 5}, {6, 6}));
  insert(3, Box2({15, 5}, {16, 6}));
  end();
  begin();
  update(1, Box2({35, 35}, {37, 37}));
  end();
  EXPECT_EQ(grid_.active(0).size(), 1u);
  for (const auto& active : grid_.active(0)) {
    EXPECT_EQ(active.call_count, 1u);
    EXPECT_EQ(active.population, 1u);
  }
}

TEST_F(SmallGrid, AnEmptyGridHasNoCellsAndLittleMemory) {
  begin();
  for (ObjectId object = 0; object < 1000; ++object) insert(object, Box2({1.0 * object, 5}, {1.0 * object, 36}));
  end();
  EXPECT_EQ(grid_.cell_count(), 16u);
  const std::size_t most = grid_.cell_bytes();
  begin();
  for (ObjectId object = 0; object < 1000; ++object) erase(object);
  end();
  EXPECT_EQ(grid_.cell_count(), 0u);
  EXPECT_EQ(grid_.find(CellCode<2>::of({0, 0})), nullptr);
  EXPECT_LT(grid_.cell_bytes(), most / 8);
}

TEST_F(SmallGrid, ACellThatIsLeftAndEnteredInOneStepStays) {
  begin();
  insert(1, Box2({5, 5}, {6, 6}));
  end();
  begin();
  update(1, Box2({15, 15}, {16, 16}));
  insert(2, Box2({5, 5}, {6, 6}));
  end();
  EXPECT_EQ(grid_.cell_count(), 2u);
  ASSERT_NE(grid_.find(CellCode<2>::of({0, 0})), nullptr);
  EXPECT_EQ(grid_.find(CellCode<2>::of({0, 0}))->size(), 1u);
}

TEST_F(SmallGrid, AHugeVisitorAsksOnlyCellsThatExist) {
  const Spec2 endless = Spec2::unlimited(1, {0, 0});
  Grid2 grid(endless, {CellKind::kRows}, 4);
  grid.begin_step(1);
  for (ObjectId object = 0; object < 3; ++object) {
    boxes_[object].after = Box2({10.0 * object, 0.5}, {10.0 * object, 0.5});
    grid.route_insert(0, object, *boxes_[object].after);
  }
  oracle::finish_step(grid, boxes_);
  boxes_.settle();
  grid.begin_step(1);
  boxes_[7].after = Box2({5, -kInfinity}, {kInfinity, kInfinity});
  grid.route_visit(0, 7, nullptr, &*boxes_[7].after, true);
  grid.end_block(0);
  EXPECT_EQ(grid.calls(0), 2u);
  EXPECT_EQ(oracle::finish_step(grid, boxes_).size(), 2u);
  EXPECT_EQ(grid.cell_count(), 3u);
}

}  // namespace
}  // namespace sweepgrid::grid_test
