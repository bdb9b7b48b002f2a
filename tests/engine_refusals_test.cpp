// Bad input: it is refused by name, and changes nothing.
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "engine_client.hpp"

namespace sweepgrid::engine_refusals_test {
namespace {

/// Two engines that are told the same; one of them is also told what it must refuse.
class EngineRefuses : public ::testing::Test {
 protected:
  EngineRefuses() {
    for (std::uint64_t key = 0; key < 20; ++key) both([&](Engine2& e) { e.insert(key, square(0.7F * key, 0)); });
    step();
    // Some are queued while the bad calls come.
    both([](Engine2& e) {
      e.update(std::uint64_t{3}, square(9, 0));
      e.erase(std::uint64_t{4});
      e.insert(100, square(2, 0));
      e.insert(101, square(2, 0));
      e.erase(std::uint64_t{101});
    });
  }

  void both(const std::function<void(Engine2&)>& call) {
    call(tried_);
    call(untouched_);
  }

  void step() {
    EXPECT_EQ(oracle::difference(untouched_.step(), tried_.step()), "");
    EXPECT_EQ(untouched_.pairs(), tried_.pairs());
    EXPECT_EQ(untouched_.size(), tried_.size());
    tried_.validate();
  }

  /// The next steps of both engines are the same, new objects included.
  void expect_unchanged() {
    for (std::uint64_t key = 0; key < 120; ++key) {
      ASSERT_EQ(tried_.contains(key), untouched_.contains(key)) << key;
      if (untouched_.contains(key)) {
        ASSERT_EQ(tried_.box(tried_.find(key).value()), untouched_.box(untouched_.find(key).value())) << key;
      }
    }
    EXPECT_EQ(untouched_.size(), tried_.size());
    step();
    both([](Engine2& e) {
      e.insert(4, square(1, 0));
      e.insert(50, square(3, 0));
      e.insert(51, square(4, 0));
      e.update(std::uint64_t{5}, square(1, 0));
      e.erase(std::uint64_t{6});
    });
    step();
    EXPECT_EQ(tried_.stats().step.begins, untouched_.stats().step.begins);
    EXPECT_EQ(tried_.stats().step.inserts, untouched_.stats().step.inserts);
    EXPECT_EQ(tried_.stats().step.updates, untouched_.stats().step.updates);
    EXPECT_EQ(tried_.stats().step.erases, untouched_.stats().step.erases);
  }

  [[nodiscard]] Handle handle(std::uint64_t key) const { return tried_.find(key).value(); }

  Engine2 tried_{serial()};
  Engine2 untouched_{serial()};
};

TEST_F(EngineRefuses, ABoxWithANan) {
  for (int place = 0; place < 4; ++place) {
    Box2 box = square(0, 0);
    (place < 2 ? box.min : box.max)[static_cast<std::size_t>(place % 2)] = kNan;
    const std::string axis = "axis " + std::to_string(place % 2);
    for (const auto& text : {refusal([&] { tried_.insert(77, box); }), refusal([&] { tried_.update(handle(7), box); }),
                             refusal([&] { tried_.update(std::uint64_t{7}, box); })}) {
      EXPECT_TRUE(has(text, "NaN"));
      EXPECT_TRUE(has(text, axis));
      EXPECT_TRUE(has(text, "object 7"));
    }
  }
  expect_unchanged();
}

TEST_F(EngineRefuses, ABoxWithMinAboveMax) {
  const Box2 box({0, 1}, {1, 0.5F});
  for (const auto& text : {refusal([&] { tried_.insert(77, box); }), refusal([&] { tried_.update(handle(7), box); }),
                           refusal([&] { tried_.update(std::uint64_t{7}, box); })}) {
    EXPECT_TRUE(has(text, "min > max"));
    EXPECT_TRUE(has(text, "axis 1"));
    EXPECT_TRUE(has(text, "object 7"));
  }
  expect_unchanged();
}

TEST_F(EngineRefuses, AKeyOfALiveObject) {
  EXPECT_TRUE(has(refusal([&] { tried_.insert(7, square(0, 0)); }), "insert of object 7"));
  EXPECT_TRUE(has(refusal([&] { tried_.insert(100, square(0, 0)); }), "insert of object 100"));  // queued
  expect_unchanged();
}

TEST_F(EngineRefuses, AnUnknownKey) {
  for (const std::uint64_t key : {std::uint64_t{4}, std::uint64_t{77}, std::uint64_t{101}}) {
    const std::string name = "object " + std::to_string(key);
    EXPECT_TRUE(has(refusal([&] { tried_.update(key, square(0, 0)); }), "update of " + name));
    EXPECT_TRUE(has(refusal([&] { tried_.erase(key); }), "erase of " + name));
    EXPECT_FALSE(tried_.find(key).has_value());
  }
  expect_unchanged();
}

TEST_F(EngineRefuses, AStaleHandle) {
  const Handle stale = handle(7);
  both([](Engine2& e) { e.erase(std::uint64_t{7}); });
  const auto expect_stale = [&] {
    EXPECT_TRUE(has(refusal([&] { tried_.update(stale, square(0, 0)); }), "update of object of handle"));
    EXPECT_TRUE(has(refusal([&] { tried_.erase(stale); }), "erase of object of handle"));
    EXPECT_TRUE(has(refusal([&] { static_cast<void>(tried_.box(stale)); }), "stale"));
    EXPECT_TRUE(has(refusal([&] { static_cast<void>(tried_.key(stale)); }), "stale"));
  };
  expect_stale();  // at once
  step();
  expect_stale();  // after the step
  for (std::uint64_t key = 200; key < 210; ++key) both([&](Engine2& e) { e.insert(key, square(0.7F * 7, 0)); });
  expect_stale();  // when its index serves another object
  step();
  expect_stale();
  expect_unchanged();
}

TEST_F(EngineRefuses, AHandleThatNeverWas) {
  for (const Handle handle : {Handle{}, Handle{5000, 0}, Handle{3, 99}, Handle{0xfffffffeU, 0}}) {
    refusal([&] { tried_.update(handle, square(0, 0)); });
    refusal([&] { tried_.erase(handle); });
    refusal([&] { static_cast<void>(tried_.box(handle)); });
  }
  expect_unchanged();
}

TEST_F(EngineRefuses, ABulkInsertWithOneBadElement) {
  const std::vector<std::uint64_t> good{60, 61, 62, 63};
  const std::vector<Box2> boxes(4, square(2, 0));
  for (const std::size_t bad : {std::size_t{0}, std::size_t{2}, std::size_t{3}}) {
    auto keys = good;
    keys[bad] = 9;  // lives
    EXPECT_TRUE(has(refusal([&] { tried_.insert(keys, boxes); }), "insert of object 9"));
    keys[bad] = keys[(bad + 1) % 4];  // twice in the call
    EXPECT_TRUE(has(refusal([&] { tried_.insert(keys, boxes); }), "object " + std::to_string(keys[bad])));
    auto bad_boxes = boxes;
    bad_boxes[bad].max[1] = kNan;
    EXPECT_TRUE(has(refusal([&] { tried_.insert(good, bad_boxes); }), "object " + std::to_string(good[bad])));
  }
  refusal([&] { tried_.insert(good, std::vector<Box2>(3, square(0, 0))); });
  refusal([&] { tried_.insert(std::vector<std::uint64_t>{60}, boxes); });
  expect_unchanged();
}

TEST_F(EngineRefuses, ABulkUpdateWithOneBadElement) {
  const std::vector<Handle> good{handle(5), handle(6), handle(7)};
  const std::vector<Box2> boxes(3, square(2, 0));
  for (std::size_t bad = 0; bad < 3; ++bad) {
    auto handles = good;
    handles[bad] = Handle{12345, 0};
    EXPECT_TRUE(has(refusal([&] { tried_.update(handles, boxes); }), "handle 12345"));
    auto bad_boxes = boxes;
    bad_boxes[bad] = Box2({2, 0}, {1, 0});
    EXPECT_TRUE(has(refusal([&] { tried_.update(good, bad_boxes); }), "object " + std::to_string(5 + bad)));
  }
  refusal([&] { tried_.update(good, std::vector<Box2>(2, square(0, 0))); });
  expect_unchanged();
}

TEST_F(EngineRefuses, ABulkEraseWithOneBadElement) {
  const std::vector<Handle> good{handle(5), handle(6), handle(100), handle(3)};
  for (std::size_t bad = 0; bad < 4; ++bad) {
    auto handles = good;
    handles[bad] = Handle{12345, 0};
    EXPECT_TRUE(has(refusal([&] { tried_.erase(handles); }), "handle 12345"));
    handles[bad] = handles[(bad + 2) % 4];  // twice
    EXPECT_TRUE(has(refusal([&] { tried_.erase(handles); }), "erase of object"));
  }
  expect_unchanged();
}

TEST_F(EngineRefuses, ASecondErase) {
  both([](Engine2& e) { e.erase(std::uint64_t{8}); });
  refusal([&] { tried_.erase(std::uint64_t{8}); });
  both([](Engine2& e) { e.insert(8, square(2, 0)); });
  expect_unchanged();
}

TEST(Engine, RefusedCallsBeforeTheFirstStepLeaveNoTrace) {
  Engine2 engine(serial());
  refusal([&] { engine.insert(std::vector<std::uint64_t>{1, 2, 1}, std::vector<Box2>(3, square(0, 0))); });
  EXPECT_EQ(engine.size(), 0u);
  EXPECT_TRUE(engine.step().begins.empty());
  engine.validate();
  engine.insert(std::vector<std::uint64_t>{1, 2}, std::vector<Box2>(2, square(0, 0)));
  EXPECT_EQ(engine.step().begins, (Pairs{{1, 2}}));
  engine.validate();
}

}  // namespace
}  // namespace sweepgrid::engine_refusals_test
