#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <sweepgrid/engine/event_order.hpp>
#include <sweepgrid/engine/key_order.hpp>

#include "op_script.hpp"

namespace sweepgrid {
namespace {

template <class Key, class Order>
std::vector<Pair<Key>> sorted_by(const std::vector<Pair<Key>>& pairs, std::size_t shards, std::size_t ranges,
                                 const std::function<std::size_t(const Pair<Key>&)>& shard_of) {
  EventOrder<Key, Order> order;
  order.reset(3);
  order.shard(1).push_back(pairs.empty() ? Pair<Key>{} : pairs[0]);  // left over from a step before
  order.reset(shards);
  for (const auto& pair : pairs) order.shard(shard_of(pair)).push_back(pair);
  for (std::size_t shard = 0; shard < shards; ++shard) order.sort_shard(shard);
  std::vector<Pair<Key>> out(5);
  const std::size_t used = order.cut(ranges, out);
  EXPECT_LE(used, ranges);
  EXPECT_EQ(used == 0, pairs.empty() || shards == 1);
  for (std::size_t range = used; range > 0; --range) order.merge_range(range - 1, out);
  return out;
}

template <class Order>
std::vector<Pair<int>> random_pairs(int count, int keys) {
  oracle::Random random(static_cast<std::uint64_t>(count));
  std::vector<Pair<int>> pairs;
  for (int i = 0; i < count; ++i) {
    pairs.push_back(EventOrder<int, Order>::pair(random.below(keys), keys + random.below(1 << 30)));
  }
  return pairs;
}

template <class Order>
void expect_same_for_any_shards_and_ranges(int count, int keys) {
  const auto pairs = random_pairs<Order>(count, keys);
  auto expected = pairs;
  std::sort(expected.begin(), expected.end(), EventOrder<int, Order>::kLess);
  for (const std::size_t shards : {1, 2, 16, 64}) {
    for (const std::size_t ranges : {1, 2, 4, 32}) {
      const auto spread = [&](const Pair<int>& pair) {
        return (static_cast<std::size_t>(pair.first) * 31 + static_cast<std::size_t>(pair.second)) % shards;
      };
      const auto skewed = [&](const Pair<int>& pair) { return pair.first % 50 == 0 ? shards - 1 : 0; };
      ASSERT_EQ((sorted_by<int, Order>(pairs, shards, ranges, spread)), expected) << shards << " " << ranges;
      ASSERT_EQ((sorted_by<int, Order>(pairs, shards, ranges, skewed)), expected) << shards << " " << ranges;
    }
  }
}

TEST(EventOrder, IsTheSameForAnyNumberOfShardsAndRanges) {
  for (const int count : {0, 1, 2, 511, 512, 1024, 5000, 20'000}) {
    expect_same_for_any_shards_and_ranges<std::less<int>>(count, 100'000);
  }
}

TEST(EventOrder, CutsManyShardsOfFewPairs) {
  std::vector<Pair<int>> pairs;
  for (int i = 0; i < 1024; ++i) pairs.push_back({i, i + 1});
  const auto evenly = [](const Pair<int>& pair) { return static_cast<std::size_t>(pair.first) % 64; };
  EXPECT_EQ((sorted_by<int, std::less<int>>(pairs, 64, 128, evenly)), pairs);
}

TEST(EventOrder, CutsWhereOneKeyIsInMostPairs) {
  // A ground plane: one first key, so that cuts must fall between pairs and not between keys.
  for (const int keys : {1, 2, 3}) expect_same_for_any_shards_and_ranges<std::less<int>>(5000, keys);
}

/// Keys from `least` on, `spread` of them, in as many pairs that they are sorted digit by digit if they may be.
template <class Key>
void expect_sorted_by_value(Key least, std::uint64_t spread) {
  oracle::Random random(spread);
  std::vector<Pair<Key>> pairs;
  for (int i = 0; i < 1000; ++i) {
    const auto some = [&] {
      const auto wide = static_cast<std::uint64_t>(random.below(1 << 30)) << 30 | random.below(1 << 30);
      return static_cast<Key>(static_cast<std::uint64_t>(least) + wide * 16 % spread);
    };
    pairs.push_back({some(), some()});
  }
  auto expected = pairs;
  std::sort(expected.begin(), expected.end(),
            [](const auto& a, const auto& b) { return std::pair(a.first, a.second) < std::pair(b.first, b.second); });
  expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
  EventOrder<Key, KeyOrder<Key>> order;
  order.reset(1);
  order.shard(0) = pairs;
  order.sort_shard(0);
  EXPECT_EQ(order.shard(0), expected);
}

TEST(EventOrder, IsThatOfTheValuesOfKeys) {
  expect_sorted_by_value<std::uint32_t>(0, 1);
  expect_sorted_by_value<std::uint32_t>(5, 2);
  expect_sorted_by_value<std::uint32_t>(0, std::uint64_t{1} << 32);
  expect_sorted_by_value<std::int32_t>(-500, 1000);
  expect_sorted_by_value<std::int32_t>(std::numeric_limits<std::int32_t>::min(), std::uint64_t{1} << 32);
  expect_sorted_by_value<std::int8_t>(-128, 256);
  expect_sorted_by_value<std::uint16_t>(60000, 5000);
  expect_sorted_by_value<std::int64_t>(std::numeric_limits<std::int64_t>::min(), 100000);
  expect_sorted_by_value<std::int64_t>(-5, std::uint64_t{1} << 27);
  expect_sorted_by_value<std::uint64_t>(std::uint64_t{1} << 40, std::uint64_t{1} << 62);
}

TEST(EventOrder, DropsDoublesOfAShard) {
  const std::vector<Pair<int>> pairs{{1, 2}, {1, 3}, {2, 3}, {2, 4}};
  for (const std::size_t shards : {1, 2}) {
    EventOrder<int, std::less<int>> order;
    order.reset(shards);
    for (const std::size_t copy : {3, 0, 2, 0, 1, 3}) order.shard(copy % shards).push_back(pairs[copy]);
    for (std::size_t shard = 0; shard < shards; ++shard) order.sort_shard(shard);
    std::vector<Pair<int>> out;
    for (std::size_t range = order.cut(2, out); range > 0; --range) order.merge_range(range - 1, out);
    EXPECT_EQ(out, pairs);
  }
}

TEST(EventOrder, FollowsTheOrderOfTheClient) {
  expect_same_for_any_shards_and_ranges<std::greater<int>>(5000, 300);
  EXPECT_EQ((EventOrder<int, std::greater<int>>::pair(1, 2)), (Pair<int>{2, 1}));
}

TEST(EventOrder, PutsTheKeysOfAPairInOrder) {
  using Order = EventOrder<int, KeyOrder<int>>;
  EXPECT_EQ(Order::pair(2, -1), (Pair<int>{-1, 2}));
  EXPECT_EQ(Order::pair(-1, 2), (Pair<int>{-1, 2}));
  EXPECT_TRUE(Order::kLess({1, 5}, {2, 3}));
  EXPECT_TRUE(Order::kLess({1, 5}, {1, 6}));
  EXPECT_FALSE(Order::kLess({1, 5}, {1, 5}));
}

TEST(EventOrder, MovesKeysThatOwnMemory) {
  std::vector<Pair<std::string>> pairs;
  for (int i = 0; i < 2000; ++i) pairs.push_back({"a long name that is not stored in place " + std::to_string(i), "b"});
  auto expected = pairs;
  using Order = KeyOrder<std::string>;
  std::sort(expected.begin(), expected.end(), EventOrder<std::string, Order>::kLess);
  const auto shard_of = [](const Pair<std::string>& pair) { return pair.first.size() % 4; };
  EXPECT_EQ((sorted_by<std::string, Order>(pairs, 4, 3, shard_of)), expected);
}

}  // namespace
}  // namespace sweepgrid
