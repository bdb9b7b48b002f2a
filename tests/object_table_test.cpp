// Objects by id, keys by object, and the arrays that both lie in.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include <sweepgrid/engine/object_table.hpp>
#include <sweepgrid/engine/stable_vector.hpp>

#include "op_script.hpp"

namespace sweepgrid::object_table_test {
namespace {

// ---- StableVector

TEST(StableVector, ElementsNeverMoveAndKeepTheirValues) {
  StableVector<std::uint32_t> vector;
  std::vector<std::uint32_t*> addresses;
  for (std::uint32_t size = 1; size <= 20'000; size += size < 5000 ? 1 : 777) {
    vector.grow(size);
    for (auto index = static_cast<std::uint32_t>(addresses.size()); index < size; ++index) {
      vector[index] = 7 * index;
      addresses.push_back(&vector[index]);
    }
  }
  const std::set<std::uint32_t*> distinct(addresses.begin(), addresses.end());
  EXPECT_EQ(distinct.size(), addresses.size());
  for (std::uint32_t index = 0; index < addresses.size(); ++index) {
    ASSERT_EQ(addresses[index], &std::as_const(vector)[index]);
    ASSERT_EQ(vector[index], 7 * index);
  }
}

TEST(StableVector, HoldsNothingAtFirstAndAtMostTwiceWhatIsAskedFor) {
  StableVector<std::uint64_t> vector;
  EXPECT_EQ(vector.bytes(), 0u);
  vector.grow(0);
  EXPECT_EQ(vector.bytes(), 0u);
  vector.grow(5000);
  EXPECT_GE(vector.bytes(), 5000 * sizeof(std::uint64_t));
  EXPECT_LE(vector.bytes(), 2 * 5000 * sizeof(std::uint64_t));
  const std::size_t bytes = vector.bytes();
  vector.grow(10);
  EXPECT_EQ(vector.bytes(), bytes);
}

TEST(StableVector, GivesBackWholeBlocksAndGrowsAgain) {
  StableVector<std::uint32_t> vector;
  vector.grow(100'000);
  for (std::uint32_t index = 0; index < 100'000; ++index) vector[index] = index;
  const std::size_t bytes = vector.bytes();
  vector.shrink(3000);
  EXPECT_LT(vector.bytes(), bytes / 10);
  for (std::uint32_t index = 0; index < 3000; ++index) ASSERT_EQ(vector[index], index);
  vector.grow(100'000);
  EXPECT_EQ(vector.bytes(), bytes);
  vector[99'999] = 5;
  for (std::uint32_t index = 0; index < 3000; ++index) ASSERT_EQ(vector[index], index);
  vector.shrink(0);
  EXPECT_EQ(vector.bytes(), 0u);
}

TEST(StableVector, CountsWholeBlocks) {
  StableVector<std::uint64_t> vector;
  vector.grow(1);
  EXPECT_EQ(vector.bytes(), 512 * sizeof(std::uint64_t));
  vector.grow(1025);
  EXPECT_EQ(vector.bytes(), 2048 * sizeof(std::uint64_t));
  vector.shrink(1024);
  EXPECT_EQ(vector.bytes(), 1024 * sizeof(std::uint64_t));
}

// ---- ObjectTable

using Table = ObjectTable<double, 2>;
using Box2 = Box<double, 2>;

const Box2 kHere({0, 0}, {1, 1});
const Box2 kThere({5, 5}, {6, 6});

/// What the engine does with an object's marks in a step.
void settle(Table& table) {
  std::vector<ObjectId> retired;
  for (ObjectId object = 0; object < table.bound(); ++object) {
    if ((table.state(object) & Table::kErased) != 0) {
      table.retire(object);
      retired.push_back(object);
    } else if (table.state(object) != 0) {
      table.state(object) = Table::kLive;
    }
  }
  for (std::uint32_t granule = 0; granule < table.granules(); ++granule) table.unmark_granule(granule);
  table.free_ids(retired);
  table.nothing_queued();
}

TEST(ObjectTable, AHandleIsGoodFromInsertToErase) {
  Table table;
  EXPECT_FALSE(table.good(Handle{}));
  EXPECT_FALSE(table.good(Handle{0, 0}));
  const Handle handle = table.insert(kHere);
  EXPECT_TRUE(table.good(handle));
  EXPECT_EQ(table.handle(handle.index), handle);
  settle(table);
  EXPECT_TRUE(table.good(handle));
  table.erase(handle.index);
  EXPECT_FALSE(table.good(handle));
  settle(table);
  EXPECT_FALSE(table.good(handle));
  const Handle next = table.insert(kThere);
  EXPECT_EQ(next.index, handle.index);
  EXPECT_TRUE(table.good(next));
  EXPECT_FALSE(table.good(handle));
}

TEST(ObjectTable, ASampleIsOfAllThatAreNotErased) {
  Table table;
  std::vector<Handle> handles;
  for (int i = 0; i < 5000; ++i) handles.push_back(table.insert(kHere));
  settle(table);
  std::vector<ObjectId> room(256);
  const auto sample = [&] {
    const std::span<const ObjectId> chosen = table.sample(room);
    EXPECT_TRUE(std::adjacent_find(chosen.begin(), chosen.end(), std::greater_equal<>()) == chosen.end());
    for (const ObjectId object : chosen) EXPECT_TRUE(table.good(table.handle(object)));
    return std::vector<ObjectId>(chosen.begin(), chosen.end());
  };
  const auto all = sample();
  EXPECT_EQ(all.size(), 256u);
  // Every 16th may be of another kind.
  const auto sixteenth = std::count_if(all.begin(), all.end(), [](ObjectId object) { return object % 16 == 0; });
  EXPECT_GT(sixteenth, 5);
  EXPECT_LT(sixteenth, 40);
  for (ObjectId quarter = 0; quarter < 4; ++quarter) {
    const auto in_quarter = std::count_if(all.begin(), all.end(), [&](ObjectId o) { return o / 1250 == quarter; });
    EXPECT_NEAR(static_cast<double>(in_quarter), 64, 2);
  }
  for (int i = 0; i < 4700; ++i) table.erase(handles[i].index);
  EXPECT_EQ(sample().size(), 256u);
  settle(table);
  EXPECT_EQ(sample().size(), 256u);
  room.resize(1000);
  EXPECT_EQ(sample().size(), 300u);
}

TEST(GranuleMarks, AreFoundInOrderUntilTheyAreTakenAway) {
  GranuleMarks marks;
  const auto marked = [&](std::uint32_t granules) {
    std::vector<std::uint32_t> found;
    marks.for_each(granules, [&](std::uint32_t granule) { found.push_back(granule); });
    return found;
  };
  marks.grow(1000);
  EXPECT_EQ(marked(1000), std::vector<std::uint32_t>{});
  for (const std::uint32_t granule : {999U, 0U, 63U, 64U, 640U, 63U}) marks.mark(granule);
  EXPECT_EQ(marked(1000), (std::vector<std::uint32_t>{0, 63, 64, 640, 999}));
  EXPECT_EQ(marked(640), (std::vector<std::uint32_t>{0, 63, 64}));
  marks.unmark(63);
  marks.unmark(640);
  for (int twice = 0; twice < 2; ++twice) EXPECT_EQ(marked(1000), (std::vector<std::uint32_t>{0, 64, 999}));
  marks.mark(641);
  marks.grow(5000);
  marks.mark(4999);
  EXPECT_EQ(marked(5000), (std::vector<std::uint32_t>{0, 64, 641, 999, 4999}));
}

TEST(ObjectTable, AnIdIsNotReusedInTheStepThatErasesIt) {
  Table table;
  const Handle first = table.insert(kHere);
  settle(table);
  table.erase(first.index);
  EXPECT_NE(table.insert(kHere).index, first.index);
}

TEST(ObjectTable, MarksWhatIsQueuedAndNothingElse) {
  Table table;
  for (int i = 0; i < 1000; ++i) table.insert(kHere);
  EXPECT_EQ(table.granules(), 4u);
  EXPECT_TRUE(table.anything_queued());
  settle(table);
  EXPECT_FALSE(table.anything_queued());
  table.update(table.handle(700), kThere);
  EXPECT_TRUE(table.anything_queued());
  for (std::uint32_t granule = 0; granule < 4; ++granule) EXPECT_EQ(table.granule_marked(granule), granule == 2);
  EXPECT_EQ(table.state(700), Table::kLive | Table::kUpdated);
  EXPECT_EQ(table.state(701), Table::kLive);
}

TEST(ObjectTable, AnUpdateToTheSameBoxIsNotQueued) {
  Table table;
  table.insert(kHere);
  settle(table);
  table.update(table.handle(0), kHere);
  EXPECT_FALSE(table.anything_queued());
  table.update(table.handle(0), kThere);
  table.update(table.handle(0), kHere);  // back again, but it has been queued by now
  EXPECT_EQ(table.record(0).box, kHere);
  EXPECT_EQ(table.state(0), Table::kLive | Table::kUpdated);
}

TEST(ObjectTable, AnInsertCanBeTakenBack) {
  Table table;
  table.insert(kHere);
  settle(table);
  const Handle second = table.insert(kThere);
  table.cancel_insert(second.index);
  EXPECT_FALSE(table.good(second));
  EXPECT_EQ(table.size(), 1u);
  EXPECT_EQ(table.state(second.index), 0);
  const Handle third = table.insert(kThere);
  EXPECT_EQ(third.index, second.index);
  EXPECT_NE(third, second);
}

TEST(ObjectTable, ARecordIsACacheLineWhereItFits) {
  ObjectTable<float, 3> table;
  static_assert(sizeof(ObjectTable<float, 3>::Record) == 64);
  for (int i = 0; i < 3000; ++i) table.insert(Box<float, 3>({0, 0, 0}, {1, 1, 1}));
  for (ObjectId object = 0; object < table.bound(); ++object) {
    ASSERT_EQ(reinterpret_cast<std::uintptr_t>(&table.record(object)) % 64, 0u);
  }
}

TEST(ObjectTable, IdsAtTheTopAreForgottenWhenFewObjectsAreLeft) {
  Table table;
  std::vector<Handle> handles;
  for (int i = 0; i < 5000; ++i) handles.push_back(table.insert(kHere));
  settle(table);
  EXPECT_FALSE(table.trim());
  for (std::size_t i = 0; i < handles.size(); ++i) {
    if (i != 3 && i != 700) table.erase(handles[i].index);
  }
  settle(table);
  EXPECT_TRUE(table.trim());
  EXPECT_EQ(table.bound(), 701u);
  EXPECT_FALSE(table.trim());
  std::set<ObjectId> ids;
  for (int i = 0; i < 5000; ++i) {
    const Handle handle = table.insert(kThere);
    EXPECT_TRUE(ids.insert(handle.index).second);
    ASSERT_TRUE(table.good(handle));
  }
  EXPECT_EQ(table.bound(), 5002u);
  for (std::size_t i = 0; i < handles.size(); ++i) ASSERT_EQ(table.good(handles[i]), i == 3 || i == 700) << i;
}

TEST(ObjectTable, TakesCallsForDifferentObjectsAtOnce) {
  Table table;
  std::vector<std::thread> threads;
  for (int own = 0; own < 4; ++own) {
    threads.emplace_back([&table, own] {
      std::vector<Handle> handles;
      for (int i = 0; i < 2000; ++i) handles.push_back(table.insert(Box2({1.0 * own, 1.0 * i}, {9, 9e9})));
      for (int i = 0; i < 2000; ++i) {
        const ObjectId object = handles[static_cast<std::size_t>(i)].index;
        if (i % 3 == 0) table.update(handles[static_cast<std::size_t>(i)], Box2({1.0 * own, -1.0 * i}, {9, 9e9}));
        if (i % 4 == 0) table.erase(object);
        EXPECT_EQ(table.record(object).box.min[0], own);
        EXPECT_EQ(table.good(handles[static_cast<std::size_t>(i)]), i % 4 != 0);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(table.bound(), 8000u);
  EXPECT_EQ(table.size(), 6000u);
  std::set<std::pair<double, double>> boxes;
  for (ObjectId object = 0; object < table.bound(); ++object) {
    boxes.emplace(table.record(object).box.min[0], table.record(object).box.min[1]);
  }
  EXPECT_EQ(boxes.size(), 8000u);
}

}  // namespace
}  // namespace sweepgrid::object_table_test
