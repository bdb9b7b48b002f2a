#include <gtest/gtest.h>

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <sweepgrid/engine/key_order.hpp>
#include <sweepgrid/engine/key_table.hpp>
#include <sweepgrid/engine/key_type.hpp>

#include "op_script.hpp"

namespace sweepgrid::key_table_test {
namespace {

/// A few values only, so that keys collide all the time and clusters wrap round the end of the buckets.
struct PoorHash {
  std::size_t operator()(int key) const { return static_cast<std::size_t>(key % 5); }
};

/// KeyTable with typed keys.
template <class Key, class Hash = std::hash<Key>>
class Keys {
 public:
  [[nodiscard]] ObjectId find(const Key& key) const { return table_.find(&key); }
  [[nodiscard]] const Key& key(ObjectId object) const { return *static_cast<const Key*>(table_.key(object)); }
  template <class Make>
  bool insert(const Key& key, Make&& make) {
    return table_.insert(&key, make);
  }
  /// The object has ended, and nobody asks for its key any more.
  void end(ObjectId object) {
    table_.erase(object);
    table_.release(object);
  }
  [[nodiscard]] KeyTable& table() { return table_; }

 private:
  KeyTable table_{key_type::of<Key, Hash, KeyOrder<Key>>()};
};

template <class Hash>
void expect_key_table_is_a_map() {
  Keys<int, Hash> table;
  std::map<int, ObjectId> map;
  std::vector<ObjectId> free;
  ObjectId next = 0;
  oracle::Random random(2);
  for (int call = 0; call < 8000; ++call) {
    const int key = random.below(call < 4000 ? 900 : 60) - 30;
    const auto found = map.find(key);
    ASSERT_EQ(table.find(key), found == map.end() ? kNoObject : found->second);
    if (found != map.end() && random.percent(50)) {
      table.table().erase(found->second);
      ASSERT_EQ(table.key(found->second), key);
      table.table().release(found->second);
      free.push_back(found->second);
      map.erase(found);
      continue;
    }
    int made = 0;
    const bool added = table.insert(key, [&] {
      ++made;
      if (free.empty()) return next++;
      const ObjectId object = free.back();
      free.pop_back();
      return object;
    });
    ASSERT_EQ(added, found == map.end());
    ASSERT_EQ(made, added ? 1 : 0);
    if (added) map[key] = made != 0 ? table.find(key) : kNoObject;
  }
  for (const auto& [key, object] : map) {
    ASSERT_EQ(table.find(key), object);
    ASSERT_EQ(table.key(object), key);
  }
}

TEST(KeyTable, IsAMap) { expect_key_table_is_a_map<std::hash<int>>(); }
TEST(KeyTable, IsAMapWithAPoorHash) { expect_key_table_is_a_map<PoorHash>(); }

TEST(KeyTable, AFailedInsertLeavesNoTrace) {
  Keys<std::string> table;
  EXPECT_THROW(table.insert("a", []() -> ObjectId { throw std::length_error("full"); }), std::length_error);
  EXPECT_EQ(table.find("a"), kNoObject);
  EXPECT_TRUE(table.insert("a", [] { return ObjectId{4}; }));
  EXPECT_EQ(table.find("a"), 4u);
  EXPECT_GT(table.table().bytes(), 0u);
}

TEST(KeyTable, TakesCallsForDifferentKeysAtOnce) {
  Keys<std::uint64_t> table;
  std::vector<std::thread> threads;
  for (std::uint64_t own = 0; own < 4; ++own) {
    threads.emplace_back([&table, own] {
      for (std::uint64_t key = own; key < 8000; key += 4) {
        table.insert(key, [&] { return static_cast<ObjectId>(key); });
        if (key % 3 == 0) table.end(static_cast<ObjectId>(key));
        if (key >= 400) static_cast<void>(table.find(key - 400));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::uint64_t key = 0; key < 8000; ++key) {
    ASSERT_EQ(table.find(key), key % 3 == 0 ? kNoObject : static_cast<ObjectId>(key));
  }
}

TEST(KeyTable, FewKeysKeepFewBuckets) {
  Keys<std::uint64_t> table;
  for (std::uint64_t key = 0; key < 50'000; ++key) table.insert(key << 32, [&] { return static_cast<ObjectId>(key); });
  const std::size_t bytes = table.table().bytes();
  for (ObjectId object = 1000; object < 50'000; ++object) table.end(object);
  for (std::uint64_t key = 0; key < 50'000; ++key) {
    ASSERT_EQ(table.find(key << 32), key < 1000 ? static_cast<ObjectId>(key) : kNoObject);
  }
  table.table().trim(1000);
  EXPECT_LT(table.table().bytes(), bytes / 10);
  ASSERT_EQ(table.key(999), std::uint64_t{999} << 32);
}

/// Counts how many of it live.
struct Counted {
  explicit Counted(int n) : number(n) { ++living; }
  Counted(const Counted& other) : number(other.number) { ++living; }
  Counted& operator=(const Counted&) = default;
  ~Counted() { --living; }
  friend auto operator<=>(const Counted& a, const Counted& b) { return a.number <=> b.number; }
  friend bool operator==(const Counted& a, const Counted& b) { return a.number == b.number; }
  int number;
  static inline int living = 0;
};
struct CountedHash {
  std::size_t operator()(const Counted& key) const { return static_cast<std::size_t>(key.number); }
};

TEST(KeyTable, HoldsCopiesFromInsertToRelease) {
  {
    Keys<Counted, CountedHash> table;
    for (int i = 0; i < 1000; ++i) table.insert(Counted(i), [&] { return static_cast<ObjectId>(i); });
    EXPECT_EQ(Counted::living, 1000);
    EXPECT_FALSE(table.insert(Counted(5), [] { return ObjectId{0}; }));
    for (ObjectId object = 0; object < 500; ++object) table.table().erase(object);
    EXPECT_EQ(Counted::living, 1000);
    for (ObjectId object = 0; object < 500; ++object) table.table().release(object);
    table.table().release(7);
    EXPECT_EQ(Counted::living, 500);
  }
  EXPECT_EQ(Counted::living, 0);
}

}  // namespace
}  // namespace sweepgrid::key_table_test
