#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <ostream>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <sweepgrid/sap/cell_kind.hpp>
#include <sweepgrid/sap/row_cell.hpp>
#include <sweepgrid/sap/row_kernels.hpp>

#include "sanitized.hpp"
#include "sap_oracle.hpp"
#include "visit_script.hpp"

namespace sweepgrid::row_cell_test {
namespace {

using oracle::BoxOp;
using oracle::CellOracle;
using oracle::Palette;
using oracle::Regime;

/// Populations at and beside every number of lanes and every multiple of it that matters.
constexpr int kPopulations[] = {0,  1,  2,  3,  4,  5,  7,  8,  9,  12, 15,  16,  17,  20,
                                31, 32, 33, 47, 48, 49, 63, 64, 65, 96, 127, 128, 129, 200};
/// Under a sanitizer, which looks for what is beyond an end.
constexpr int kFewPopulations[] = {0, 1, 3, 4, 5, 8, 9, 16, 17, 33, 64, 129};

std::span<const int> populations() {
  if (oracle::kSanitized && !oracle::plays_all()) return kFewPopulations;
  return kPopulations;
}

/// Uses the kernels for one instruction set while it lives.
class WithTarget {
 public:
  explicit WithTarget(const std::string& target) { use_row_kernel_target(target); }
  ~WithTarget() { use_row_kernel_target(""); }
};

template <class Scalar, int Dim>
std::string play_rows() {
  for (const int population : populations()) {
    for (const Palette palette : {Palette::kFine, Palette::kLattice, Palette::kExtremes}) {
      for (const int moving : {10, 100}) {
        RowCell<Scalar, Dim> cell;
        CellOracle<Scalar, Dim> oracle;
        const Regime regime{.name = "rows",
                            .palette = palette,
                            .population = population,
                            .moving_percent = moving,
                            .churn_percent = 20,
                            .drains = 6};
        std::string wrong = oracle::play_visits(cell, oracle, regime, static_cast<std::uint64_t>(population));
        if (!wrong.empty()) return wrong;
      }
    }
  }
  return {};
}

/// The boxes of a step as refresh() asks for them.
template <class Scalar, int Dim>
struct NewBoxes {
  std::map<ObjectId, Box<Scalar, Dim>> boxes;
  std::set<ObjectId> moved;

  [[nodiscard]] bool changed(ObjectId object) const { return moved.count(object) != 0; }
  [[nodiscard]] const Box<Scalar, Dim>& after(ObjectId object) const { return boxes.at(object); }
};

template <class Scalar, int Dim>
std::vector<std::tuple<ObjectId, OrderedBox<Scalar, Dim>>> residents_of(const RowCell<Scalar, Dim>& cell) {
  std::vector<typename RowCell<Scalar, Dim>::Resident> residents;
  cell.append_residents(residents);
  std::sort(residents.begin(), residents.end(), [](const auto& a, const auto& b) { return a.object < b.object; });
  std::vector<std::tuple<ObjectId, OrderedBox<Scalar, Dim>>> all;
  for (const auto& resident : residents) all.emplace_back(resident.object, resident.box);
  return all;
}

// Erases, a refresh, then inserts against one drain of everything: the same net deltas, counts and residents.
template <class Scalar, int Dim>
std::string refresh_rows() {
  using Op = CellOp<Scalar, Dim>;
  for (const int population : populations()) {
    for (const int moving : {0, 40, 100}) {
      RowCell<Scalar, Dim> drained;
      RowCell<Scalar, Dim> refreshed;
      typename RowCell<Scalar, Dim>::RefreshScratch scratch;
      NewBoxes<Scalar, Dim> boxes;
      oracle::OpScript<Scalar, Dim> script(
          Regime{.name = "refresh", .population = population, .moving_percent = moving, .churn_percent = 10}, 7);
      for (int step = 0; step < 6; ++step) {
        std::vector<Op> all;
        std::vector<Op> erases;
        std::vector<Op> inserts;
        boxes.moved.clear();
        for (const auto& op : script.next()) {
          all.push_back({op.object, op.kind, OrderedBox<Scalar, Dim>(op.box)});
          if (op.kind != OpKind::kErase) boxes.boxes[op.object] = op.box;
          if (op.kind == OpKind::kUpdate) boxes.moved.insert(op.object);
          if (op.kind == OpKind::kErase) erases.push_back(all.back());
          if (op.kind == OpKind::kInsert) inserts.push_back(all.back());
        }
        DeltaList expected;
        DeltaList deltas;
        SapCounters expected_counters;
        SapCounters counters;
        drained.drain(all, expected, expected_counters);
        refreshed.drain(erases, deltas, counters);
        const std::size_t moved = refreshed.refresh(boxes, scratch, deltas, counters);
        refreshed.drain(inserts, deltas, counters);
        const auto net = [](const DeltaList& all_deltas) {
          std::map<PairKey, int> sums;
          for (const OverlapDelta& delta : all_deltas) sums[delta.pair] += delta.change;
          std::erase_if(sums, [](const auto& entry) { return entry.second == 0; });
          return sums;
        };
        const std::string where = std::to_string(population) + " objects, step " + std::to_string(step);
        if (moved != boxes.moved.size()) return "number of moved objects: " + where;
        if (net(expected) != net(deltas)) return "deltas: " + where;
        // Up to four axes each pair gives one delta; above, each op meets what the ones before it left.
        if (Dim <= 4 && !(counters == expected_counters)) return "counters: " + where;
        if (residents_of(drained) != residents_of(refreshed)) return "residents: " + where;
      }
    }
  }
  return {};
}

struct Space {
  const char* name;
  std::string (*play)();
  std::string (*refresh)();
};

template <class Scalar, int Dim>
Space space(const char* name) {
  return {name, play_rows<Scalar, Dim>, refresh_rows<Scalar, Dim>};
}

/// Kernels are for 1 to 4 dimensions of 32 and 64 bits. All; or for each number of dimensions one width.
template <bool kAll>
std::vector<Space> spaces() {
  std::vector<Space> spaces = {space<float, 1>("float1"), space<double, 2>("double2"),
                               space<float, 3>("float3"), space<double, 4>("double4"),
                               space<float, 5>("float5"), space<std::int16_t, 2>("short2")};
  if constexpr (kAll) {
    const std::vector<Space> others = {space<double, 1>("double1"),      space<float, 2>("float2"),
                                       space<double, 3>("double3"),      space<float, 4>("float4"),
                                       space<double, 5>("double5"),      space<std::int32_t, 3>("int3"),
                                       space<std::uint32_t, 2>("uint2"), space<std::int64_t, 3>("long3")};
    spaces.insert(spaces.end(), others.begin(), others.end());
  }
  return spaces;
}

void PrintTo(const Space& space, std::ostream* out) { *out << space.name; }

class EveryTarget : public testing::TestWithParam<std::tuple<std::string, Space>> {};

TEST_P(EveryTarget, DrainsTransfersAndVisitsAreExact) {
  const auto& [target, space] = GetParam();
  const WithTarget with_target(target);
  EXPECT_EQ(space.play(), "");
}

TEST_P(EveryTarget, RefreshIsADrainOfUpdates) {
  const auto& [target, space] = GetParam();
  const WithTarget with_target(target);
  EXPECT_EQ(space.refresh(), "");
}

INSTANTIATE_TEST_SUITE_P(Rows, EveryTarget,
                         testing::Combine(testing::ValuesIn(row_kernel_targets()),
                                          testing::ValuesIn(spaces<!oracle::kSanitized>())),
                         [](const auto& test) {
                           return std::get<std::string>(test.param) + "_" + std::get<Space>(test.param).name;
                         });

/// What a cell said, drain by drain and visit by visit, and what it counted.
template <class Scalar, int Dim>
std::pair<std::vector<std::pair<PairKey, int>>, SapCounters> story(const std::string& target) {
  const WithTarget with_target(target);
  std::vector<std::pair<PairKey, int>> story;
  SapCounters counters;
  for (const int population : populations()) {
    RowCell<Scalar, Dim> cell;
    oracle::OpScript<Scalar, Dim> script(
        Regime{.name = "story", .population = population, .moving_percent = 50, .churn_percent = 10}, 5);
    for (int step = 0; step < 8; ++step) {
      std::vector<CellOp<Scalar, Dim>> ops;
      for (const auto& op : script.next()) ops.push_back({op.object, op.kind, OrderedBox<Scalar, Dim>(op.box)});
      DeltaList deltas;
      cell.drain(ops, deltas, counters);
      std::sort(deltas.begin(), deltas.end(), [](const auto& a, const auto& b) { return a.pair < b.pair; });
      for (const auto& [pair, change] : deltas) story.emplace_back(pair, change);
    }
  }
  return {story, counters};
}

TEST(RowKernels, AllTargetsGiveTheSameDeltasAndCounters) {
  const auto floats = story<float, 3>("");
  const auto doubles = story<double, 2>("");
  EXPECT_GT(floats.first.size(), 1000U);
  for (const std::string& target : row_kernel_targets()) {
    EXPECT_EQ((story<float, 3>(target)), floats) << target;
    EXPECT_EQ((story<double, 2>(target)), doubles) << target;
  }
}

TEST(RowKernels, RefuseATargetThatIsNotThere) {
  EXPECT_FALSE(row_kernel_targets().empty());
  const std::size_t before = row_kernel_targets().size();
  EXPECT_THROW(use_row_kernel_target("Z80"), std::invalid_argument);
  EXPECT_EQ(row_kernel_targets().size(), before);
}

class EveryKind : public testing::TestWithParam<CellKind> {};

INSTANTIATE_TEST_SUITE_P(Cells, EveryKind,
                         testing::Values(CellKind::kRows, CellKind::kBatch, CellKind::kSegmented, CellKind::kClassic,
                                         CellKind::kPlane));

TEST_P(EveryKind, TransfersAndVisitsAreExact) {
  for (const int population : {0, 1, 10, 60, 200}) {
    for (const Palette palette : {Palette::kFine, Palette::kLattice, Palette::kExtremes}) {
      const auto cell = make_cell<double, 3>({GetParam()});
      CellOracle<double, 3> oracle;
      const Regime regime{.name = "kinds", .palette = palette, .population = population, .churn_percent = 20};
      EXPECT_EQ(oracle::play_visits(*cell, oracle, regime, 3), "");
    }
  }
}

TEST_P(EveryKind, TransferRefusesAWrongOpByNameAndStaysAsItWas) {
  using Op = CellOp<float, 2>;
  const OrderedBox<float, 2> box(Box<float, 2>({0, 0}, {1, 1}));
  const auto cell = make_cell<float, 2>({GetParam()});
  SapCounters counters;
  cell->transfer(std::vector<Op>{{1, OpKind::kInsert, box}, {2, OpKind::kInsert, box}}, counters);
  const std::vector<std::vector<Op>> wrong{{{3, OpKind::kInsert, box}, {77, OpKind::kErase, {}}},
                                           {{77, OpKind::kErase, {}}, {2, OpKind::kErase, {}}}};
  for (const std::vector<Op>& ops : wrong) {
    try {
      cell->transfer(ops, counters);
      ADD_FAILURE() << "nothing was thrown";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("object 77"), std::string::npos) << error.what();
    }
    EXPECT_EQ(cell->size(), 2U);
  }
}

/// Boxes over all that a scalar can say, which an empty interval made of the two ends of its range would overlap.
template <class Scalar>
void boxes_over_everything() {
  using Limits = std::numeric_limits<Scalar>;
  const Box<Scalar, 2> everything({Limits::lowest(), Limits::lowest()}, {Limits::max(), Limits::max()});
  for (const std::string& target : row_kernel_targets()) {
    const WithTarget with_target(target);
    for (const int count : populations()) {
      RowCell<Scalar, 2> cell;
      CellOracle<Scalar, 2> oracle;
      std::vector<BoxOp<Scalar, 2>> ops;
      for (ObjectId object = 0; object < static_cast<ObjectId>(count); ++object) {
        ops.push_back({object, OpKind::kInsert, everything});
      }
      ASSERT_EQ(oracle.drain(cell, ops), "") << target << ", " << count;
      const std::vector<oracle::BoxVisit<Scalar, 2>> visits{{1000, true, false, everything, {}},
                                                            {1001, false, true, {}, everything},
                                                            {1002, true, true, everything, everything},
                                                            {1003, false, false, everything, everything}};
      EXPECT_EQ(oracle.visit(cell, visits), "") << target << ", " << count;
      for (auto& op : ops) op.kind = op.object % 3 == 0 ? OpKind::kErase : OpKind::kUpdate;
      EXPECT_EQ(oracle.drain(cell, ops), "") << target << ", " << count;
    }
  }
}

TEST(RowCell, KnowsBoxesOverEverythingFromNone) {
  boxes_over_everything<std::int32_t>();
  boxes_over_everything<std::uint32_t>();
  boxes_over_everything<std::int64_t>();
}

std::vector<CellOp<float, 3>> inserts(ObjectId first, ObjectId end) {
  std::vector<CellOp<float, 3>> ops;
  for (ObjectId object = first; object < end; ++object) {
    const auto x = static_cast<float>(object);
    ops.push_back({object, OpKind::kInsert, OrderedBox<float, 3>(Box<float, 3>({x, 0, 0}, {x + 1.5F, 1, 1}))});
  }
  return ops;
}

TEST(RowCell, EachPairThatChangesHasOneDelta) {
  RowCell<float, 3> cell;
  DeltaList deltas;
  SapCounters counters;
  auto ops = inserts(0, 100);
  cell.drain(ops, deltas, counters);
  EXPECT_EQ(deltas.size(), 99U);
  deltas.clear();
  // All move along: one after another they would part and meet again.
  for (auto& op : ops) {
    const auto x = static_cast<float>(op.object + 10);
    op = {op.object, OpKind::kUpdate, OrderedBox<float, 3>(Box<float, 3>({x, 0, 0}, {x + 1.5F, 1, 1}))};
  }
  cell.drain(ops, deltas, counters);
  EXPECT_TRUE(deltas.empty());
}

TEST(RowCell, IsSmallAndCanBeMoved) {
  static_assert(sizeof(RowCell<float, 3>) <= 24);
  std::vector<RowCell<float, 3>> cells;
  DeltaList deltas;
  SapCounters counters;
  for (ObjectId first = 0; first < 20; ++first) cells.emplace_back().drain(inserts(first, 2 * first), deltas, counters);
  for (std::size_t index = 0; index < cells.size(); ++index) {
    EXPECT_EQ(cells[index].size(), index);
    cells[index].validate();
  }
  cells[3] = std::move(cells[5]);
  EXPECT_EQ(cells[3].size(), 5U);
  cells[5] = RowCell<float, 3>();
  EXPECT_EQ(cells[5].size(), 0U);
  EXPECT_EQ(cells[5].bytes(), 0U);
}

TEST(RowCell, HoldsLittleMoreMemoryThanItUses) {
  RowCell<float, 3> cell;
  DeltaList deltas;
  SapCounters counters;
  constexpr std::size_t kObject = 28;
  constexpr std::size_t kVector = 64;
  for (ObjectId object = 0; object < 1000; ++object) {
    cell.drain(inserts(object, object + 1), deltas, counters);
    EXPECT_LE(cell.bytes(), kObject * (object + 4 + object / 15) + kVector) << object;
  }
  while (cell.size() > 0) {
    const auto object = static_cast<ObjectId>(cell.size() - 1);
    cell.drain(std::vector<CellOp<float, 3>>{{object, OpKind::kErase, {}}}, deltas, counters);
    EXPECT_LE(cell.bytes(), kObject * (object + 4 + object / 8) + kVector) << object;
  }
}

}  // namespace
}  // namespace sweepgrid::row_cell_test
