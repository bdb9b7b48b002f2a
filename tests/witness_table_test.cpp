#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <sweepgrid/engine/witness_table.hpp>
#include <sweepgrid/sap/invariant.hpp>

#include "op_script.hpp"

namespace sweepgrid::witness_table_test {
namespace {

struct Finished {
  std::vector<PairKey> begins;
  std::vector<PairKey> ends;
};

Finished finish(WitnessTable& table) {
  Finished result;
  table.finish(result.begins, result.ends);
  std::sort(result.begins.begin(), result.begins.end());
  std::sort(result.ends.begin(), result.ends.end());
  return result;
}

void apply(WitnessTable& table, const std::vector<OverlapDelta>& deltas) { table.apply(deltas); }

using Pairs = std::vector<PairKey>;
const PairKey kPair(3, 8);

TEST(WitnessTable, APairBeginsWithItsFirstWitnessAndEndsWithItsLast) {
  WitnessTable table;
  apply(table, {{kPair, 1}});
  EXPECT_EQ(finish(table).begins, Pairs{kPair});
  apply(table, {{kPair, 1}});
  Finished more = finish(table);
  EXPECT_TRUE(more.begins.empty() && more.ends.empty());
  EXPECT_EQ(table.count(kPair), 2);
  apply(table, {{kPair, -1}});
  more = finish(table);
  EXPECT_TRUE(more.begins.empty() && more.ends.empty());
  apply(table, {{kPair, -1}});
  EXPECT_EQ(finish(table).ends, Pairs{kPair});
  EXPECT_EQ(table.count(kPair), 0);
  EXPECT_EQ(table.size(), 0u);
}

TEST(WitnessTable, OnlyTheNetChangeOfAStepIsAnEvent) {
  WitnessTable table;
  apply(table, {{kPair, 1}, {kPair, -1}});
  Finished none = finish(table);
  EXPECT_TRUE(none.begins.empty() && none.ends.empty());
  EXPECT_EQ(table.size(), 0u);

  apply(table, {{kPair, 1}});
  finish(table);
  // A migration: the cell that is left may speak first or last, below zero or above in between.
  apply(table, {{kPair, -1}, {kPair, 1}});
  apply(table, {{kPair, 1}, {kPair, -1}});
  none = finish(table);
  EXPECT_TRUE(none.begins.empty() && none.ends.empty());
  EXPECT_EQ(table.count(kPair), 1);

  apply(table, {{kPair, -1}, {kPair, -1}, {kPair, 1}});
  EXPECT_EQ(finish(table).ends, Pairs{kPair});
}

TEST(WitnessTable, ACountBelowZeroIsABrokenInvariant) {
  WitnessTable table;
  apply(table, {{kPair, -1}});
  Finished result;
  try {
    table.finish(result.begins, result.ends);
    FAIL() << "nothing was thrown";
  } catch (const InvariantError& error) {
    EXPECT_EQ(error.invariant(), "E1");
    EXPECT_NE(std::string(error.what()).find("3 and 8"), std::string::npos);
  }
}

TEST(WitnessTable, KnowsNothingWhenEmpty) {
  WitnessTable table;
  EXPECT_EQ(table.count(kPair), 0);
  EXPECT_EQ(table.size(), 0u);
  const Finished none = finish(table);
  EXPECT_TRUE(none.begins.empty() && none.ends.empty());
}

TEST(WitnessTable, TakesPairsOfTheSmallestAndLargestIds) {
  WitnessTable table;
  const Pairs pairs{PairKey(0, 1), PairKey(0, 0xfffffffeU), PairKey(0xfffffffdU, 0xfffffffeU)};
  for (const PairKey pair : pairs) apply(table, {{pair, 1}});
  EXPECT_EQ(finish(table).begins, pairs);
  for (const PairKey pair : pairs) EXPECT_EQ(table.count(pair), 1);
}

TEST(WitnessTable, AgreesWithAMapThroughGrowthAndChurn) {
  oracle::Random random(7);
  WitnessTable table;
  std::map<PairKey, int> counts;
  for (const int ids : {3, 12, 60, 200, 60, 12, 3}) {
    for (int step = 0; step < 30; ++step) {
      const std::map<PairKey, int> before = counts;
      std::vector<OverlapDelta> deltas;
      for (int i = 0; i < 20 * ids; ++i) {
        const auto a = static_cast<ObjectId>(random.below(ids));
        const auto b = static_cast<ObjectId>(random.below(ids));
        if (a == b) continue;
        const PairKey pair(a, b);
        const bool up = counts[pair] == 0 || random.percent(40);
        counts[pair] += up ? 1 : -1;
        deltas.push_back({pair, up ? 1 : -1});
      }
      // A scene that shrinks: what is left of larger ids goes.
      for (auto& [pair, count] : counts) {
        if (static_cast<int>(pair.upper()) < ids) continue;
        for (; count > 0; --count) deltas.push_back({pair, -1});
      }
      for (std::size_t i = deltas.size(); i > 1; --i) {
        std::swap(deltas[i - 1], deltas[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
      }
      std::erase_if(counts, [](const auto& entry) { return entry.second == 0; });
      Finished expected;
      for (const auto& [pair, count] : counts) {
        if (before.count(pair) == 0) expected.begins.push_back(pair);
      }
      for (const auto& [pair, count] : before) {
        if (counts.count(pair) == 0) expected.ends.push_back(pair);
      }
      table.apply(std::span(deltas).first(deltas.size() / 2));
      table.apply(std::span(deltas).subspan(deltas.size() / 2));
      const Finished actual = finish(table);
      ASSERT_EQ(actual.begins, expected.begins);
      ASSERT_EQ(actual.ends, expected.ends);
      ASSERT_EQ(table.size(), counts.size());
      for (const auto& [pair, count] : counts) ASSERT_EQ(table.count(pair), count);
      Pairs pairs;
      table.append_pairs(pairs);
      std::sort(pairs.begin(), pairs.end());
      ASSERT_EQ(pairs.size(), counts.size());
      ASSERT_TRUE(std::equal(pairs.begin(), pairs.end(), counts.begin(),
                             [](PairKey pair, const auto& entry) { return pair == entry.first; }));
    }
  }
}

TEST(WitnessTable, GivesMemoryBackWhenPairsGo) {
  WitnessTable table;
  std::vector<OverlapDelta> deltas;
  for (ObjectId object = 1; object <= 20'000; ++object) deltas.push_back({PairKey(0, object), 1});
  table.apply(deltas);
  finish(table);
  const std::size_t most = table.bytes();
  for (OverlapDelta& delta : deltas) delta.change = -1;
  table.apply(deltas);
  EXPECT_EQ(finish(table).ends.size(), 20'000u);
  table.note_step();
  for (int step = 0; step < 63; ++step) {
    finish(table);
    table.note_step();
  }
  EXPECT_GT(table.bytes(), most / 10);
  table.pass(1);
  EXPECT_EQ(table.bytes(), 0u);
  apply(table, {{kPair, 1}});
  EXPECT_EQ(finish(table).begins, Pairs{kPair});
}

TEST(WitnessTable, TheHashSpreadsOverUpperAndLowerBits) {
  std::map<std::uint64_t, int> upper;
  std::map<std::uint64_t, int> lower;
  for (ObjectId a = 0; a < 64; ++a) {
    for (ObjectId b = a + 1; b < a + 65; ++b) {
      ++upper[WitnessTable::hash(PairKey(a, b)) >> 58];
      ++lower[WitnessTable::hash(PairKey(a, b)) & 63];
    }
  }
  for (const auto& bits : {upper, lower}) {
    EXPECT_EQ(bits.size(), 64u);
    for (const auto& [value, count] : bits) EXPECT_LT(count, 64 * 64 / 64 * 3) << value;
  }
}

}  // namespace
}  // namespace sweepgrid::witness_table_test
