// CandidateLists: equal to a set of pairs; a change that was but prepared leaves no trace; memory goes back.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include <sweepgrid/engine/candidate_lists.hpp>

namespace sweepgrid::candidate_lists_test {
namespace {

std::vector<ObjectId> others_of(const std::set<PairKey>& pairs, ObjectId object) {
  std::set<ObjectId> others;
  for (const PairKey pair : pairs) {
    if (pair.lower() == object) others.insert(pair.upper());
    if (pair.upper() == object) others.insert(pair.lower());
  }
  return {others.begin(), others.end()};
}

TEST(CandidateLists, AreASetOfPairs) {
  constexpr ObjectId kObjects = 700;  // in three runs
  std::mt19937 random(1);
  CandidateLists lists;
  lists.grow(kObjects);
  std::set<PairKey> pairs;
  std::size_t entries = 0;
  for (int step = 0; step < 200; ++step) {
    std::vector<PairKey> added;
    std::vector<PairKey> removed;
    for (int i = 0; i < 60; ++i) {
      // Few objects have most pairs, so lists are long and short.
      const ObjectId a = random() % (i % 2 == 0 ? kObjects : 5);
      const ObjectId b = random() % kObjects;
      if (a == b) continue;
      const PairKey pair(a, b);
      if (pairs.count(pair) == 0) added.insert(added.end(), 1 + random() % 2, pair);
    }
    for (const PairKey pair : pairs) {
      if (random() % (step % 50 < 25 ? 40 : 10) == 0) removed.push_back(pair);
    }
    const std::size_t shards = 1 + random() % 3;
    const bool fails = step % 4 == 1;
    std::size_t grown = 0;
    std::size_t shrunk = 0;
    for (std::size_t index = 0; index < shards; ++index) {
      CandidateLists::Shard shard;
      shard.reset(index, shards);
      shard.add(added);
      shard.remove(removed);
      lists.prepare(shard);
      if (fails) continue;
      lists.apply(shard);
      grown += shard.entries_added();
      shrunk += shard.entries_removed();
    }
    if (!fails) {
      EXPECT_EQ(grown, 2 * std::set(added.begin(), added.end()).size());
      EXPECT_EQ(shrunk, 2 * removed.size());
      entries += grown - shrunk;
      pairs.insert(added.begin(), added.end());
      for (const PairKey pair : removed) pairs.erase(pair);
    }
    ASSERT_EQ(entries, 2 * pairs.size());
    lists.end_step(entries);
    for (ObjectId object = 0; object < kObjects; ++object) {
      const auto list = lists.of(object);
      ASSERT_EQ(std::vector<ObjectId>(list.begin(), list.end()), others_of(pairs, object)) << step << ", " << object;
    }
  }
}

TEST(CandidateLists, GiveBackWhatACrowdNeeded) {
  constexpr ObjectId kObjects = 300;
  CandidateLists lists;
  lists.grow(kObjects);
  const std::size_t empty = lists.bytes();
  std::vector<PairKey> crowd;
  for (ObjectId a = 0; a < kObjects; ++a) {
    for (ObjectId b = 0; b < a; ++b) crowd.emplace_back(a, b);
  }
  CandidateLists::Shard shard;
  shard.reset(0, 1);
  shard.add(crowd);
  lists.prepare(shard);
  lists.apply(shard);
  lists.end_step(2 * crowd.size());
  const std::size_t most = lists.bytes();
  EXPECT_GE(most, empty + 2 * crowd.size() * sizeof(ObjectId));
  shard.reset(0, 1);
  shard.remove(crowd);
  lists.prepare(shard);
  lists.apply(shard);
  for (int step = 0; step < 60; ++step) lists.end_step(0);
  EXPECT_EQ(lists.bytes(), most);  // it may come again
  for (int step = 60; step < 3 * 64; ++step) lists.end_step(0);
  EXPECT_EQ(lists.bytes(), empty);
}

}  // namespace
}  // namespace sweepgrid::candidate_lists_test
