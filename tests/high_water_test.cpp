// HighWater: memory that no step of the latest 64 used half of goes back, and none that one did.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <random>
#include <vector>

#include <sweepgrid/sap/high_water.hpp>

namespace sweepgrid::high_water_test {
namespace {

std::size_t rounded(std::size_t used) { return (used + 15) / 16 * 16; }

TEST(HighWater, TellsTheMostOf64Steps) {
  HighWater water;
  EXPECT_EQ(water.most(), 0U);
  water.note(1000);
  water.note(400);
  for (int step = 2; step < 64; ++step) {
    EXPECT_EQ(water.most(), rounded(1000)) << step;
    water.note(0);
  }
  EXPECT_EQ(water.most(), rounded(1000));
  water.note(0);
  EXPECT_EQ(water.most(), rounded(400));
  water.note(0);
  EXPECT_EQ(water.most(), 0U);
}

// Beside a queue of what the latest steps used.
TEST(HighWater, IsNeverLessThanTheMostNorMuchOlder) {
  std::mt19937 random(1);
  for (int scene = 0; scene < 200; ++scene) {
    HighWater water;
    std::deque<std::size_t> used;
    const std::size_t spread = std::size_t{1} << (scene % 20);
    const bool falls = scene % 3 == 0;
    for (std::size_t step = 0; step < 500; ++step) {
      const std::size_t use = falls ? spread * (500 - step % 200) / 500 : random() % (random() % spread + 1);
      water.note(use);
      used.push_front(use);
      if (used.size() > 128) used.pop_back();
      const auto most_of = [&](std::size_t steps) {
        const auto end = used.begin() + static_cast<std::ptrdiff_t>(std::min(steps, used.size()));
        return rounded(*std::max_element(used.begin(), end));
      };
      ASSERT_GE(water.most(), most_of(64));
      ASSERT_LE(water.most(), most_of(128));
    }
  }
}

TEST(HighWater, ManyIdleStepsAreAsGoodAsOneAfterTheOther) {
  std::mt19937 random(2);
  HighWater one;
  HighWater other;
  for (int turn = 0; turn < 3000; ++turn) {
    const std::size_t use = random() % 1000;
    const std::size_t idle = random() % (turn % 10 == 0 ? 90 : 5);
    one.note(use);
    other.note(use);
    for (std::size_t step = 0; step < idle; ++step) one.note(0);
    other.pass(idle);
    ASSERT_EQ(one.most(), other.most());
  }
}

TEST(HighWater, OfSoManyThatNoneCanBeCountedKeepsAll) {
  HighWater water;
  water.note(~std::size_t{0});
  EXPECT_GE(water.allowed(), ~std::size_t{0} - 1);
}

TEST(HighWater, AListThatRepeatsWithin64StepsIsAllocatedOnce) {
  HighWater water;
  std::vector<int> list;
  const int* memory = nullptr;
  for (int step = 0; step < 1000; ++step) {
    water.recycle(list);
    EXPECT_TRUE(list.empty());
    for (int i = 0; i < (step % 63 == 0 ? 1000 : 3); ++i) list.push_back(i);
    if (step == 0) memory = list.data();
    ASSERT_EQ(list.data(), memory) << step;
  }
}

TEST(HighWater, WhatWasUsedOnceGoesBackAfter64Steps) {
  HighWater water;
  std::vector<int> list(1000);
  for (int step = 0; step < 64; ++step) {
    water.recycle(list);
    ASSERT_GE(list.capacity(), 1000U) << step;
    list.resize(10);
  }
  water.recycle(list);
  EXPECT_EQ(list.capacity(), 0U);
}

}  // namespace
}  // namespace sweepgrid::high_water_test
