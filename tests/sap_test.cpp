#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <sweepgrid/sap/cell_kind.hpp>
#include <sweepgrid/sap/classic_sap.hpp>
#include <sweepgrid/sap/sweeping_plane.hpp>

#include "op_script.hpp"
#include "sanitized.hpp"
#include "sap_oracle.hpp"
#include "sap_play.hpp"

namespace sweepgrid::sap_test {

namespace {

using oracle::BoxOp;
using oracle::CellOracle;
using oracle::Regime;

struct NamedKind {
  const char* name;
  CellOptions options;
};

constexpr NamedKind kKinds[] = {{"Rows", {CellKind::kRows}},
                                {"Classic", {CellKind::kClassic}},
                                {"Plane", {CellKind::kPlane}},
                                {"Batch", {CellKind::kBatch}},
                                {"Segmented4", {CellKind::kSegmented, 4}},
                                {"Segmented5", {CellKind::kSegmented, 5}},
                                {"Segmented8", {CellKind::kSegmented, 8}},
                                {"Segmented32", {CellKind::kSegmented, 32}},
                                {"OneByOne4", {CellKind::kSegmented, 4, Integration::kOneByOne}},
                                {"OneByOne16", {CellKind::kSegmented, 16, Integration::kOneByOne}},
                                {"Presorted4", {CellKind::kSegmented, 4, Integration::kPresorted}},
                                {"Presorted16", {CellKind::kSegmented, 16, Integration::kPresorted}}};

struct Space {
  const char* name;
  std::string (*play)(const CellOptions&, const Regime&, std::uint64_t seed);
};

using oracle::play_cell;
constexpr Space kSpaces[] = {
#ifndef SWEEPGRID_COMPILED_AHEAD_ONLY
    {"float1", play_cell<float, 1>},      {"float4", play_cell<float, 4>},
    {"int1", play_cell<std::int32_t, 1>}, {"uint2", play_cell<std::uint32_t, 2>},
#endif
    {"float2", play_cell<float, 2>},      {"float3", play_cell<float, 3>},
    {"double2", play_cell<double, 2>},    {"double3", play_cell<double, 3>},
    {"int3", play_cell<std::int32_t, 3>}, {"short2", play_cell<std::int16_t, 2>}};

void PrintTo(const NamedKind& kind, std::ostream* out) { *out << kind.name; }
void PrintTo(const Space& space, std::ostream* out) { *out << space.name; }

/// SWEEPGRID_TEST_SEED picks other scripts, SWEEPGRID_TEST_ROUNDS plays more of them.
std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* const value = std::getenv(name);
  return value == nullptr ? otherwise : std::strtoull(value, nullptr, 10);
}

class CellDeltas : public testing::TestWithParam<std::tuple<NamedKind, Space>> {};

TEST_P(CellDeltas, SumToTheChangeOfEveryPair) {
  const auto& [kind, space] = GetParam();
  const std::uint64_t seed = from_environment("SWEEPGRID_TEST_SEED", 1);
  const std::uint64_t rounds = from_environment("SWEEPGRID_TEST_ROUNDS", 1);
  // A part of the regimes, such that each meets every kind and every space.
  const std::size_t stride = oracle::plays_all() ? 1 : oracle::kSanitized ? 7 : 2;
  std::size_t turn = oracle::first_turn(kind.name) + oracle::first_turn(space.name);
  for (const Regime& regime : oracle::kRegimes) {
    if (++turn % stride != 0) continue;
    for (std::uint64_t round = 0; round < rounds; ++round) {
      const std::string wrong = space.play(kind.options, regime, seed + round);
      if (!wrong.empty()) FAIL() << wrong;
    }
  }
}

std::string name_of(const testing::TestParamInfo<std::tuple<NamedKind, Space>>& test) {
  return std::string(std::get<NamedKind>(test.param).name) + "_" + std::get<Space>(test.param).name;
}

std::string name_of_kind(const testing::TestParamInfo<NamedKind>& test) { return test.param.name; }

INSTANTIATE_TEST_SUITE_P(Oracle, CellDeltas, testing::Combine(testing::ValuesIn(kKinds), testing::ValuesIn(kSpaces)),
                         name_of);

using Box2 = Box<float, 2>;
using Op2 = BoxOp<float, 2>;
using Cell2 = SweepAndPrune<float, 2>;

Box2 square(float x, float y, float width = 1) { return Box2({x, y}, {x + width, y + width}); }

class AnyCell : public testing::TestWithParam<NamedKind> {
 protected:
  std::string drain(const std::vector<Op2>& ops) { return oracle_.drain(*cell_, ops); }

  std::unique_ptr<Cell2> cell_ = make_cell<float, 2>(GetParam().options);
  CellOracle<float, 2> oracle_;
};

INSTANTIATE_TEST_SUITE_P(Cells, AnyCell, testing::ValuesIn(kKinds), name_of_kind);

/// Drains one op into `cell` and returns the message of the std::invalid_argument that it must throw.
std::string refusal(Cell2& cell, const std::vector<Op2>& ops) {
  std::vector<CellOp<float, 2>> cell_ops;
  for (const Op2& op : ops) cell_ops.push_back({op.object, op.kind, OrderedBox<float, 2>(op.box)});
  DeltaList deltas;
  SapCounters counters;
  try {
    cell.drain(cell_ops, deltas, counters);
  } catch (const std::invalid_argument& error) {
    EXPECT_TRUE(deltas.empty());
    EXPECT_EQ(counters, SapCounters());
    return error.what();
  }
  return "nothing was thrown";
}

TEST_P(AnyCell, RefusesAWrongOpByNameAndStaysAsItWas) {
  ASSERT_EQ(drain({{1, OpKind::kInsert, square(0, 0)}, {2, OpKind::kInsert, square(0.5F, 0)}}), "");
  const Op2 good[] = {{3, OpKind::kInsert, square(0, 0)}, {2, OpKind::kErase, {}}, {1, OpKind::kUpdate, square(9, 9)}};
  const Op2 wrong[] = {
      {1, OpKind::kInsert, square(0, 0)}, {7654, OpKind::kUpdate, square(0, 0)}, {7654, OpKind::kErase, {}}};
  for (const Op2& op : wrong) {
    std::vector<Op2> ops{op};
    for (const Op2& other : good) {
      if (other.object != op.object) ops.push_back(other);
    }
    const std::string object = "object " + std::to_string(op.object);
    for (std::size_t turn = 0; turn < ops.size(); ++turn) {
      EXPECT_NE(refusal(*cell_, ops).find(object), std::string::npos) << refusal(*cell_, ops);
      EXPECT_EQ(drain({}), "");
      std::rotate(ops.begin(), ops.begin() + 1, ops.end());
    }
  }
  // Still in step with the oracle after ops that make use of all that is there.
  EXPECT_EQ(drain({{1, OpKind::kUpdate, square(3, 3)}, {3, OpKind::kInsert, square(0.5F, 0)}}), "");
  EXPECT_EQ(drain({{1, OpKind::kErase, {}}, {2, OpKind::kErase, {}}, {3, OpKind::kErase, {}}}), "");
}

TEST_P(AnyCell, ErasedObjectsCannotBeErasedAgain) {
  ASSERT_EQ(drain({{5, OpKind::kInsert, square(0, 0)}}), "");
  ASSERT_EQ(drain({{5, OpKind::kErase, {}}}), "");
  EXPECT_NE(refusal(*cell_, {{5, OpKind::kErase, {}}}).find("object 5"), std::string::npos);
  EXPECT_EQ(drain({{5, OpKind::kInsert, square(0, 0)}}), "");
}

TEST_P(AnyCell, BoxesThatOnlyTouchOverlap) {
  ASSERT_EQ(drain({{1, OpKind::kInsert, square(0, 0)}, {2, OpKind::kInsert, square(1, 1)}}), "");
  EXPECT_EQ(oracle_.overlaps(), std::vector<PairKey>{PairKey(1, 2)});
  ASSERT_EQ(drain({{2, OpKind::kUpdate, square(std::nextafter(1.0F, 2.0F), 1)}}), "");
  EXPECT_TRUE(oracle_.overlaps().empty());
  ASSERT_EQ(drain({{2, OpKind::kUpdate, square(-1, 1)}}), "");
  EXPECT_EQ(oracle_.overlaps(), std::vector<PairKey>{PairKey(1, 2)});
}

TEST_P(AnyCell, UnchangedBoxesMakeNoSwapsAndNoDeltas) {
  oracle::OpScript<float, 2> script(Regime{.name = "unchanged", .population = 200}, 3);
  ASSERT_EQ(drain(script.next()), "");
  ASSERT_EQ(drain(script.next()), "");
  for (const int moving : {1, 3, 1000}) {
    std::vector<Op2> ops;
    for (const auto& [object, box] : oracle_.boxes()) {
      if (ops.size() < static_cast<std::size_t>(moving)) ops.push_back({object, OpKind::kUpdate, box});
    }
    const SapCounters before = oracle_.counters();
    ASSERT_EQ(drain(ops), "");
    EXPECT_EQ(oracle_.counters().swaps, before.swaps);
    EXPECT_EQ(oracle_.counters().deltas, before.deltas);
  }
}

TEST_P(AnyCell, DrainsOfNothingDoNothing) {
  EXPECT_EQ(drain({}), "");
  ASSERT_EQ(drain({{1, OpKind::kInsert, square(0, 0)}}), "");
  const SapCounters before = oracle_.counters();
  EXPECT_EQ(drain({}), "");
  EXPECT_EQ(oracle_.counters().swaps, before.swaps);
  EXPECT_EQ(oracle_.counters().box_tests, before.box_tests);
}

TEST_P(AnyCell, CountsTheSameWorkForTheSameOps) {
  const auto counters_of = [&] {
    oracle::OpScript<float, 2> script(Regime{.name = "repeat", .moving_percent = 30, .churn_percent = 5}, 11);
    const auto cell = make_cell<float, 2>(GetParam().options);
    CellOracle<float, 2> witness;
    for (int step = 0; step < 10; ++step) EXPECT_EQ(witness.drain(*cell, script.next()), "");
    return witness.counters();
  };
  EXPECT_EQ(counters_of(), counters_of());
}

TEST_P(AnyCell, MemoryIsGivenBackOrReusedWhenAllIsErased) {
  oracle::OpScript<float, 2> script(Regime{.name = "waves", .population = 400, .all_or_nothing = true}, 5);
  std::size_t first_wave = 0;
  for (int wave = 0; wave < (oracle::kSanitized && !oracle::plays_all() ? 6 : 20); ++wave) {
    ASSERT_EQ(drain(script.next()), "");
    ASSERT_EQ(drain(script.next()), "");
    if (wave == 1) first_wave = cell_->bytes();
  }
  EXPECT_LE(cell_->bytes(), 2 * first_wave);
}

/// Endpoints of `axis` as ClassicSap orders them, with the slots that it gave: ascending from the first drain on.
std::vector<Endpoint<float>> classic_endpoints(const std::vector<Box2>& boxes, int axis) {
  std::vector<Endpoint<float>> endpoints;
  for (Slot slot = 0; slot < boxes.size(); ++slot) {
    endpoints.push_back(Endpoint<float>::min_of(slot, ordered_bits(boxes[slot].min[axis])));
    endpoints.push_back(Endpoint<float>::max_of(slot, ordered_bits(boxes[slot].max[axis])));
  }
  return endpoints;
}

TEST(ClassicSap, SwapsAreTheInversionsOfTheOldOrder) {
  oracle::OpScript<float, 2> script(Regime{.name = "inversions", .palette = oracle::Palette::kLattice}, 7);
  ClassicSap<float, 2> cell;
  CellOracle<float, 2> oracle;
  const auto boxes_of = [&oracle] {
    std::vector<Box2> boxes;
    for (const auto& [object, box] : oracle.boxes()) boxes.push_back(box);
    return boxes;
  };
  std::vector<Op2> inserts;
  for (int drain = 0; drain < 2; ++drain) {
    for (const Op2& op : script.next()) {
      if (op.kind == OpKind::kInsert) inserts.push_back({static_cast<ObjectId>(inserts.size()), op.kind, op.box});
    }
  }
  ASSERT_EQ(oracle.drain(cell, inserts), "");
  for (int step = 0; step < 10; ++step) {
    const std::vector<Box2> before = boxes_of();
    std::vector<Op2> updates;
    for (const Op2& op : script.next()) {
      updates.push_back({static_cast<ObjectId>(updates.size()), OpKind::kUpdate, op.box});
    }
    const std::uint64_t swaps = oracle.counters().swaps;
    ASSERT_EQ(oracle.drain(cell, updates), "");

    std::uint64_t inversions = 0;
    const std::vector<Box2> after = boxes_of();
    for (int axis = 0; axis < 2; ++axis) {
      const auto from = classic_endpoints(before, axis);
      const auto to = classic_endpoints(after, axis);
      for (std::size_t a = 0; a < from.size(); ++a) {
        for (std::size_t b = 0; b < from.size(); ++b) inversions += from[a] < from[b] && to[b] < to[a] ? 1 : 0;
      }
    }
    EXPECT_EQ(oracle.counters().swaps - swaps, inversions);
  }
}

TEST(ClassicSap, InsertsAndErasesCostSwapsAlongTheWholeList) {
  ClassicSap<float, 1> cell;
  CellOracle<float, 1> oracle;
  std::vector<BoxOp<float, 1>> row;
  for (ObjectId object = 0; object < 100; ++object) {
    const auto x = static_cast<float>(2 * object);
    row.push_back({object, OpKind::kInsert, Box<float, 1>({x}, {x + 1})});
  }
  ASSERT_EQ(oracle.drain(cell, row), "");
  EXPECT_EQ(oracle.counters().swaps, 0U);
  ASSERT_EQ(oracle.drain(cell, std::vector<BoxOp<float, 1>>{{1000, OpKind::kInsert, Box<float, 1>({-3}, {-2})}}), "");
  EXPECT_EQ(oracle.counters().swaps, 2U * 200U);
  ASSERT_EQ(oracle.drain(cell, std::vector<BoxOp<float, 1>>{{1000, OpKind::kErase, {}}}), "");
  EXPECT_EQ(oracle.counters().swaps, 4U * 200U);
}

TEST(SweepingPlane, TestsExactlyThePairsThatMeetOnTheFirstAxis) {
  SweepingPlane<float, 2> cell;
  CellOracle<float, 2> oracle;
  std::vector<Op2> column;
  for (ObjectId object = 0; object < 10; ++object) {
    column.push_back({object, OpKind::kInsert, square(0, 2 * static_cast<float>(object))});
    column.push_back({object + 100, OpKind::kInsert, square(5, 2 * static_cast<float>(object))});
  }
  ASSERT_EQ(oracle.drain(cell, column), "");
  EXPECT_EQ(oracle.counters().box_tests, 2U * 45U);
}

TEST(MakeCell, RefusesSegmentsOfTooFewOrTooManyEndpoints) {
  for (const int capacity : {-1, 0, 3, 65537, 2'000'000'000}) {
    EXPECT_THROW((make_cell<float, 2>({CellKind::kSegmented, capacity})), std::invalid_argument) << capacity;
  }
  EXPECT_NO_THROW((make_cell<float, 2>({CellKind::kSegmented, 4})));
  EXPECT_NO_THROW((make_cell<float, 2>({CellKind::kSegmented, 65536})));
}

}  // namespace
}  // namespace sweepgrid::sap_test
