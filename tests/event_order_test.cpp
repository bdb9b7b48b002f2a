#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <sweepgrid/engine/digit_sort.hpp>
#include <sweepgrid/engine/event_order.hpp>
#include <sweepgrid/engine/events.hpp>
#include <sweepgrid/engine/key_order.hpp>
#include <sweepgrid/scheduler/executor.hpp>
#include <sweepgrid/scheduler/stage_graph.hpp>

#include "op_script.hpp"

namespace sweepgrid::event_order_test {
namespace {

/// So many workers as far as anybody can see; one thread does all, the last task first.
class Backwards final : public Executor {
 public:
  explicit Backwards(int workers) : workers_(workers) {}
  [[nodiscard]] int concurrency() const override { return workers_; }
  [[nodiscard]] int worker() const override { return 0; }
  void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override {
    while (count > 0) body(--count);
  }
  void execute(const std::function<void()>& work) override { work(); }

 private:
  int workers_;
};

/// Events of objects with these keys, to be sorted again and again.
template <class Key, class Order = KeyOrder<Key>>
class Sorter {
 public:
  using List = std::vector<Pair<Key>>;
  /// Begins, by list of the engine.
  using Found = std::vector<std::vector<PairKey>>;

  explicit Sorter(const std::vector<Key>& keys) : keys_(key_type::of<Key, std::hash<Key>, Order>()) {
    for (const Key& key : keys) {
      keys_.insert(&key, [&] { return count_++; });
    }
  }

  [[nodiscard]] Key key(ObjectId object) const { return *static_cast<const Key*>(keys_.key(object)); }

  /// `steps`: how often, so that what is left of the step before is seen.
  List sort(const Found& begins, int workers, int steps = 2) {
    Events<Key> events;
    const auto executor = std::make_shared<Backwards>(workers);
    StageGraph graph(executor);
    Found empty(begins.size());
    const Found* found = &empty;
    EventOrder order(keys_, {[&] { return found->size(); },
                             [&](EventOrder::List list, std::size_t i) {
                               return list == EventOrder::kBegins ? std::span<const PairKey>((*found)[i])
                                                                  : std::span<const PairKey>();
                             },
                             [&] { return count_; }});
    const auto first = graph.add(
        "first", {}, [](std::vector<std::uint64_t>& /*costs*/) {}, [](std::size_t /*task*/) {});
    order.add_stages(graph, first, *executor);
    order.write_to({&events.ends, &events.begins});
    for (int step = 0; step < steps; ++step) {
      found = step % 2 == 1 ? &begins : &empty;
      graph.run();
      EXPECT_TRUE(events.ends.empty());
    }
    return events.begins;
  }

  /// What is expected.
  [[nodiscard]] List sorted(const Found& found) const {
    List list;
    const Order less;
    for (const auto& pairs : found) {
      for (const PairKey pair : pairs) {
        const Key a = key(pair.lower());
        const Key b = key(pair.upper());
        list.push_back(less(b, a) ? Pair<Key>{b, a} : Pair<Key>{a, b});
      }
    }
    std::sort(list.begin(), list.end(), [&](const auto& a, const auto& b) {
      return less(a.first, b.first) || (!less(b.first, a.first) && less(a.second, b.second));
    });
    list.erase(std::unique(list.begin(), list.end()), list.end());
    return list;
  }

 private:
  KeyTable keys_;
  ObjectId count_ = 0;
};

/// `count` pairs of `objects` objects in `lists` lists, some of them several times in their list.
std::vector<std::vector<PairKey>> random_pairs(int count, int objects, std::size_t lists) {
  oracle::Random random(static_cast<std::uint64_t>(count * 7 + objects));
  std::vector<std::vector<PairKey>> found(lists);
  for (int i = 0; i < count; ++i) {
    const auto a = static_cast<ObjectId>(random.below(objects));
    const auto b = static_cast<ObjectId>(random.below(objects));
    if (a == b) continue;
    const PairKey pair(a, b);
    auto& list = found[pair.bits() % lists];
    list.insert(list.end(), static_cast<std::size_t>(1 + random.below(2)), pair);
  }
  return found;
}

template <class Key, class Order = KeyOrder<Key>>
void expect_same_for_any_lists_and_workers(const std::vector<Key>& keys, int count, int objects = 0) {
  Sorter<Key, Order> sorter(keys);
  for (const std::size_t lists : {std::size_t{1}, std::size_t{3}, std::size_t{70}}) {
    const auto found = random_pairs(count, objects > 0 ? objects : static_cast<int>(keys.size()), lists);
    const auto expected = sorter.sorted(found);
    for (const int workers : {1, 2, 16}) {
      ASSERT_EQ(sorter.sort(found, workers), expected) << count << " pairs, " << lists << " lists, " << workers;
    }
  }
}

/// `count` distinct keys, not in their order.
template <class Key>
std::vector<Key> keys_between(Key least, std::uint64_t spread, int count) {
  std::vector<Key> keys;
  const std::uint64_t stride = std::max<std::uint64_t>(1, spread / static_cast<std::uint64_t>(count));
  for (int i = 0; i < count; ++i) {
    const auto place = static_cast<std::uint64_t>(i * 7919 % count);  // 7919 is prime
    keys.push_back(static_cast<Key>(static_cast<std::uint64_t>(least) + place * stride));
  }
  return keys;
}

TEST(EventOrder, IsTheSameForAnyNumberOfListsAndWorkers) {
  for (const int count : {0, 1, 2, 511, 512, 5000, 20'000}) {
    expect_same_for_any_lists_and_workers(keys_between<std::int32_t>(-500, 1000, 1000), count);
  }
}

TEST(EventOrder, CutsWhereOneObjectIsInMostPairs) {
  // A ground plane: cuts must fall between pairs, not between objects.
  for (const int objects : {2, 3, 40})
    expect_same_for_any_lists_and_workers(keys_between<int>(0, 5000, 5000), 5000, objects);
}

TEST(EventOrder, IsThatOfTheValuesOfKeys) {
  constexpr std::uint64_t kAll32 = std::uint64_t{1} << 32;
  expect_same_for_any_lists_and_workers(keys_between<std::uint32_t>(0, kAll32, 900), 3000);
  expect_same_for_any_lists_and_workers(
      keys_between<std::int32_t>(std::numeric_limits<std::int32_t>::min(), kAll32, 900), 3000);
  expect_same_for_any_lists_and_workers(keys_between<std::int8_t>(-128, 256, 256), 3000);
  expect_same_for_any_lists_and_workers(keys_between<std::uint16_t>(60'000, 5000, 900), 3000);
  expect_same_for_any_lists_and_workers(
      keys_between<std::int64_t>(std::numeric_limits<std::int64_t>::min(), 100'000, 900), 3000);
  expect_same_for_any_lists_and_workers(keys_between<std::int64_t>(-5, std::uint64_t{1} << 27, 900), 3000);
  expect_same_for_any_lists_and_workers(
      keys_between<std::uint64_t>(std::uint64_t{1} << 40, std::uint64_t{1} << 62, 900), 3000);
}

TEST(EventOrder, FollowsTheOrderOfTheClient) {
  expect_same_for_any_lists_and_workers<int, std::greater<int>>(keys_between<int>(-300, 600, 600), 5000);
}

TEST(EventOrder, OfKeysThatOwnMemory) {
  std::vector<std::string> keys;
  for (int i = 0; i < 500; ++i) {
    keys.push_back("a long name that is not stored in place " + std::to_string(i * 7919 % 500));
  }
  for (const int count : {1, 400, 6000}) expect_same_for_any_lists_and_workers(keys, count);
}

/// Tells apart by hundreds only.
struct ByHundred {
  bool operator()(int a, int b) const { return a / 100 < b / 100; }
};

TEST(EventOrder, OfKeysThatTieIsRefusedByTheSameNamesForAnyWorkers) {
  const auto keys = keys_between<int>(0, 100'000, 1000);  // one in each hundred
  expect_same_for_any_lists_and_workers<int, ByHundred>(keys, 4000);
  auto with_ties = keys;
  with_ties.insert(with_ties.end(), {70'001, 30'002, 30'001});
  for (const std::size_t lists : {std::size_t{1}, std::size_t{70}}) {
    auto found = random_pairs(4000, 1000, lists);
    for (const ObjectId tied : {1000U, 1001U, 1002U}) found[0].push_back(PairKey(0, tied));
    for (const int workers : {1, 2, 16}) {
      Sorter<int, ByHundred> sorter(with_ties);
      std::string error;
      try {
        sorter.sort(found, workers);
      } catch (const std::invalid_argument& refused) {
        error = refused.what();
      }
      EXPECT_NE(error.find("not total"), std::string::npos) << workers;
      EXPECT_NE(error.find("object 30000"), std::string::npos) << error;
      EXPECT_NE(error.find("object 30001"), std::string::npos) << error;
    }
  }
}

TEST(DigitSort, SortsByFirstThenSecondWhateverTheSpread) {
  oracle::Random random(5);
  DigitSort digits;
  for (const int bits : {1, 8, 20, 27, 40, 63}) {
    for (const int count : {0, 1, 2, 63, 64, 1000, 5000}) {
      std::vector<RankPair> pairs;
      const auto rank = [&] {
        const auto wide = static_cast<std::uint64_t>(random.below(1 << 30)) << 33 |
                          static_cast<std::uint64_t>(random.below(1 << 30)) << 3;
        return std::numeric_limits<std::uint64_t>::max() - (wide >> (63 - bits));
      };
      for (int i = 0; i < count; ++i) pairs.push_back({rank(), rank()});
      auto expected = pairs;
      std::sort(expected.begin(), expected.end(), [](const auto& a, const auto& b) {
        return std::pair(a.first, a.second) < std::pair(b.first, b.second);
      });
      digits.sort(pairs);
      ASSERT_EQ(pairs, expected) << bits << " bits, " << count << " pairs";
    }
  }
}

TEST(DigitSort, GivesBackWhatItDoesNotNeedForLong) {
  DigitSort digits;
  std::vector<RankPair> many(10'000, RankPair{1, 2});
  digits.sort(many);
  EXPECT_GE(digits.bytes(), 10'000 * sizeof(RankPair));
  for (int step = 0; step < 200; ++step) digits.rest();
  EXPECT_LT(digits.bytes(), 1000u);
}

}  // namespace
}  // namespace sweepgrid::event_order_test
