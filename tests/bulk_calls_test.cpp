// Calls for many objects at once: the same as as many calls for one, wholly or not at all, with workers and without.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <sweepgrid/engine/engine.hpp>

namespace sweepgrid::bulk_calls_test {
namespace {

using Key = std::uint64_t;
using Engine2 = Engine<float, 2>;
using Box2 = Box<float, 2>;

constexpr std::size_t kMany = 60'000;  // enough for bulk calls to use workers

Config with_threads(int threads) {
  Config config;
  config.threads = threads;
  config.parallel_from = 0;
  return config;
}

/// Boxes in rows that overlap a few others, another one for each `move`.
Box2 box_of(Key key, int move) {
  const auto column = static_cast<float>(key % 250);
  const auto row = static_cast<float>(key / 250);
  const auto shift = static_cast<float>((key * 7 + static_cast<Key>(move) * 5) % 8) / 8;
  return Box2({column + shift, row}, {column + shift + 0.75F, row + 0.5F});
}

struct Scene {
  explicit Scene(std::size_t count, Key first = 0) {
    for (std::size_t i = 0; i < count; ++i) keys.push_back(first + i);
  }
  [[nodiscard]] std::vector<Box2> boxes(int move) const {
    std::vector<Box2> boxes;
    for (const Key key : keys) boxes.push_back(box_of(key, move));
    return boxes;
  }
  std::vector<Key> keys;
};

template <class T>
std::vector<T> shuffled(std::vector<T> items, unsigned seed) {
  std::mt19937 random(seed);
  std::shuffle(items.begin(), items.end(), random);
  return items;
}

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

void expect_same_step(Engine2& expected, Engine2& actual) {
  const auto& events = expected.step();
  ASSERT_TRUE(actual.step() == events);
  ASSERT_EQ(actual.size(), expected.size());
  ASSERT_TRUE(actual.stats().step == expected.stats().step);
}

class BulkCalls : public ::testing::TestWithParam<int> {
 protected:
  [[nodiscard]] static int threads() { return GetParam(); }
};

INSTANTIATE_TEST_SUITE_P(Threads, BulkCalls, ::testing::Values(1, 4));

// ---- the same as one by one

TEST_P(BulkCalls, GiveTheHandlesEventsAndCountersOfOneByOneCalls) {
  for (const std::size_t count : {std::size_t{900}, kMany}) {
    Engine2 single(with_threads(1));
    Engine2 bulk(with_threads(threads()));
    const auto insert = [&](const Scene& scene) {
      std::vector<Handle> handles;
      const auto boxes = scene.boxes(0);
      for (std::size_t i = 0; i < boxes.size(); ++i) handles.push_back(single.insert(scene.keys[i], boxes[i]));
      EXPECT_TRUE(bulk.insert(scene.keys, boxes) == handles);
      return handles;
    };
    const auto update = [&](const std::vector<Handle>& handles, int move) {
      std::vector<Box2> boxes;
      for (const Handle handle : handles) boxes.push_back(box_of(single.key(handle), move));
      for (std::size_t i = 0; i < handles.size(); ++i) single.update(handles[i], boxes[i]);
      bulk.update(handles, boxes);
    };
    const auto erase = [&](const std::vector<Handle>& handles) {
      for (const Handle handle : handles) single.erase(handle);
      bulk.erase(handles);
    };
    std::vector<Handle> handles = insert(Scene(count));
    update(handles, 1);  // new ones
    expect_same_step(single, bulk);
    update(handles, 2);
    expect_same_step(single, bulk);
    update(handles, 2);  // to the boxes that they have
    EXPECT_TRUE(bulk.step() == Events<Key>{});
    static_cast<void>(single.step());
    handles = shuffled(handles, 1);
    update(handles, 3);
    update(handles, 4);  // queued already
    expect_same_step(single, bulk);
    const std::vector<Handle> erased(handles.begin(), handles.begin() + static_cast<std::ptrdiff_t>(2 * count / 3));
    erase(erased);
    insert(Scene(count / 4, 2 * count));  // ids of the erased ones are not free yet
    expect_same_step(single, bulk);
    insert(Scene(count, 4 * count));  // they are now, and not enough
    expect_same_step(single, bulk);
    single.validate();
    bulk.validate();
    for (const Handle handle : erased) ASSERT_THROW(static_cast<void>(bulk.key(handle)), std::invalid_argument);
    for (const Key key : Scene(count, 4 * count).keys) ASSERT_EQ(bulk.key(bulk.find(key).value()), key);
  }
}

TEST_P(BulkCalls, TheLastOfSeveralUpdatesOfOneObjectWins) {
  Engine2 single(with_threads(1));
  Engine2 bulk(with_threads(threads()));
  const Scene scene(kMany);
  const std::vector<Handle> handles = bulk.insert(scene.keys, scene.boxes(0));
  single.insert(scene.keys, scene.boxes(0));
  expect_same_step(single, bulk);
  for (const bool queued : {false, true}) {
    std::vector<Handle> twice;
    for (const Handle handle : handles) {
      twice.push_back(handle);
      if (handle.index % 3 == 0) twice.push_back(handle);
    }
    for (const unsigned seed : {0U, 1U, 2U}) {
      if (seed > 0) twice = shuffled(twice, seed);
      std::vector<Box2> boxes;
      // The first of two may be the box that the object has.
      for (std::size_t i = 0; i < twice.size(); ++i) boxes.push_back(box_of(twice[i].index, static_cast<int>(i % 5)));
      if (queued) {
        for (std::size_t i = 0; i < handles.size(); i += 7) {
          single.update(handles[i], box_of(i, 9));
          bulk.update(handles[i], box_of(i, 9));
        }
      }
      for (std::size_t i = 0; i < twice.size(); ++i) single.update(twice[i], boxes[i]);
      bulk.update(twice, boxes);
      for (const Handle handle : handles) ASSERT_EQ(bulk.box(handle), single.box(handle));
      expect_same_step(single, bulk);
    }
  }
  bulk.validate();
}

// ---- wholly or not at all

/// Two engines that are told the same; one of them is also told what it must refuse.
class BulkCallsRefuse : public BulkCalls {
 protected:
  BulkCallsRefuse() {
    std::vector<Handle> erased;
    both([&](Engine2& e) {
      handles_ = e.insert(scene_.keys, scene_.boxes(0));
      erased = e.insert(Scene(20, kNew + 10).keys, std::vector<Box2>(20, box_of(3, 0)));
    });
    step();
    both([&](Engine2& e) { e.erase(erased); });
    step();
    // Some are queued while the bad calls come: updated, erased, inserted.
    stale_ = handles_[7];
    both([&](Engine2& e) {
      for (std::size_t i = 100; i < kMany; i += 100) e.update(handles_[i], box_of(i, 3));
      e.erase(stale_);
      handles_[7] = e.insert(kNew, box_of(kNew, 0));
      e.erase(e.insert(kNew + 1, box_of(kNew, 0)));
    });
  }

  void both(const std::function<void(Engine2&)>& call) {
    call(tried_);
    call(untouched_);
  }
  void step() { expect_same_step(untouched_, tried_); }

  void expect_unchanged() {
    ASSERT_EQ(tried_.size(), untouched_.size());
    for (const Handle handle : handles_) ASSERT_EQ(tried_.box(handle), untouched_.box(handle));
    for (const Key key : Scene(kMany + 200).keys) ASSERT_EQ(tried_.find(key), untouched_.find(key)) << key;
    for (const Key key : Scene(100, kNew).keys) ASSERT_EQ(tried_.find(key), untouched_.find(key)) << key;
    step();
    // New objects get the ids that they would have got.
    const Scene news(100, 2 * kNew);
    ASSERT_TRUE(tried_.insert(news.keys, news.boxes(0)) == untouched_.insert(news.keys, news.boxes(0)));
    both([&](Engine2& e) { e.update(handles_, scene_.boxes(5)); });
    step();
    tried_.validate();
  }

  static constexpr Key kNew = 1'000'000;
  static constexpr std::size_t kPlaces[] = {0, kMany / 2, kMany - 1};
  static constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

  Scene scene_{kMany};
  Engine2 tried_{with_threads(threads())};
  Engine2 untouched_{with_threads(1)};
  std::vector<Handle> handles_;  // of live objects
  Handle stale_;
};

INSTANTIATE_TEST_SUITE_P(Threads, BulkCallsRefuse, ::testing::Values(1, 4));

TEST_P(BulkCallsRefuse, AnUpdateWithOneBadItem) {
  for (const bool in_order : {true, false}) {
    const std::vector<Handle> good = in_order ? handles_ : shuffled(handles_, 5);
    for (const std::size_t place : kPlaces) {
      auto boxes = scene_.boxes(6);
      boxes[place].max[1] = kNan;
      const std::string name = "object " + std::to_string(tried_.key(good[place])) + ":";
      EXPECT_NE(refusal([&] { tried_.update(good, boxes); }).find(name), std::string::npos);
      auto handles = good;
      for (const Handle bad : {stale_, Handle{}, Handle{4'000'000'000U, 0}, Handle{5, 77}}) {
        handles[place] = bad;
        const std::string text = "handle " + std::to_string(bad.index) + " ";
        EXPECT_NE(refusal([&] { tried_.update(handles, scene_.boxes(6)); }).find(text), std::string::npos);
      }
    }
  }
  expect_unchanged();
}

TEST_P(BulkCallsRefuse, AnUpdateThatNamesObjectsTwiceAndHasABadItem) {
  std::vector<Handle> twice = handles_;
  twice.insert(twice.end(), handles_.begin(), handles_.end());
  std::vector<Box2> boxes = scene_.boxes(6);
  for (const Box2& box : scene_.boxes(2)) boxes.push_back(box);
  boxes.back() = Box2({1, 0}, {0, 0});
  refusal([&] { tried_.update(twice, boxes); });
  expect_unchanged();
}

TEST_P(BulkCallsRefuse, TheFirstBadItemIsNamed) {
  auto boxes = scene_.boxes(6);
  for (const std::size_t place : {std::size_t{41'000}, std::size_t{20'003}, std::size_t{59'000}}) {
    boxes[place].max[1] = kNan;
  }
  EXPECT_NE(refusal([&] { tried_.update(handles_, boxes); }).find("object 20003:"), std::string::npos);
  const Scene news(kMany, 2 * kNew);
  EXPECT_NE(refusal([&] { tried_.insert(news.keys, boxes); }).find("object 2020003:"), std::string::npos);
  expect_unchanged();
}

TEST_P(BulkCallsRefuse, AnInsertWithOneBadItem) {
  const Scene news(kMany, 2 * kNew);
  for (const std::size_t place : kPlaces) {
    auto boxes = news.boxes(0);
    boxes[place].min[0] = kNan;
    const std::string name = "object " + std::to_string(news.keys[place]) + ":";
    EXPECT_NE(refusal([&] { tried_.insert(news.keys, boxes); }).find(name), std::string::npos);
    for (const Key known : {Key{9}, kNew, news.keys[kMany / 3]}) {  // lives, queued, twice in the call
      auto keys = news.keys;
      keys[place] = known;
      const std::string text = "insert of object " + std::to_string(known) + ": the key names";
      EXPECT_NE(refusal([&] { tried_.insert(keys, news.boxes(0)); }).find(text), std::string::npos);
    }
  }
  expect_unchanged();
}

TEST_P(BulkCallsRefuse, AnEraseWithOneBadItem) {
  for (const bool in_order : {true, false}) {
    const std::vector<Handle> good = in_order ? handles_ : shuffled(handles_, 5);
    for (const std::size_t place : kPlaces) {
      auto handles = good;
      handles[place] = stale_;
      EXPECT_NE(refusal([&] { tried_.erase(handles); }).find("is stale"), std::string::npos);
      handles[place] = good[kMany / 3];
      const std::string text = "object " + std::to_string(tried_.key(handles[place])) + ": the call names it twice";
      EXPECT_NE(refusal([&] { tried_.erase(handles); }).find(text), std::string::npos);
    }
  }
  expect_unchanged();
}

TEST_P(BulkCallsRefuse, ManyRefusedCallsLeaveNoTraceInMemory) {
  const Scene news(kMany, 2 * kNew);
  auto boxes = news.boxes(0);
  boxes.back().min[0] = kNan;
  refusal([&] { tried_.insert(news.keys, boxes); });
  const std::size_t bytes = tried_.stats().bytes_objects;
  for (int i = 0; i < 5; ++i) refusal([&] { tried_.insert(news.keys, boxes); });
  EXPECT_EQ(tried_.stats().bytes_objects, bytes);
  expect_unchanged();
}

// ---- at once

TEST_P(BulkCalls, MayRunAtOnceForDifferentObjects) {
  Engine2 single(with_threads(1));
  Engine2 bulk(with_threads(threads()));
  const auto from_two_threads = [](const std::function<void(std::size_t)>& call) {
    std::thread other([&] { call(1); });
    call(0);
    other.join();
  };
  const Scene scenes[] = {Scene(kMany / 2), Scene(kMany / 2, kMany / 2)};
  std::vector<Handle> handles[2];
  from_two_threads([&](std::size_t own) { handles[own] = bulk.insert(scenes[own].keys, scenes[own].boxes(0)); });
  for (const Scene& scene : scenes) single.insert(scene.keys, scene.boxes(0));
  EXPECT_TRUE(bulk.step() == single.step());
  from_two_threads([&](std::size_t own) {
    bulk.update(shuffled(handles[own], 1), scenes[own].boxes(1));
    bulk.update(handles[own], scenes[own].boxes(2));
    bulk.erase(std::span(handles[own]).first(kMany / 3));
    auto bad = handles[own];
    bad.back() = Handle{};
    refusal([&] { bulk.update(bad, scenes[own].boxes(3)); });
    refusal([&] { bulk.insert(scenes[own].keys, scenes[own].boxes(0)); });
  });
  for (const Scene& scene : scenes) {
    const auto boxes = scene.boxes(2);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      i < kMany / 3 ? single.erase(scene.keys[i]) : single.update(scene.keys[i], boxes[i]);
    }
  }
  EXPECT_TRUE(bulk.step() == single.step());
  bulk.validate();
}

// ---- memory

TEST_P(BulkCalls, MemoryComesBackWhenMostAreErased) {
  Engine2 engine(with_threads(threads()));
  const Scene scene(kMany);
  const std::vector<Handle> old = engine.insert(scene.keys, scene.boxes(0));
  engine.step();
  const std::size_t bytes = engine.stats().bytes_objects;
  engine.erase(std::span(old).subspan(1000));
  engine.step();
  EXPECT_LT(engine.stats().bytes_objects, bytes / 10);
  engine.validate();
  // Ids are used again, but old handles stay stale.
  const std::vector<Key> keys(scene.keys.begin() + 1000, scene.keys.end());
  const std::vector<Box2> boxes = scene.boxes(0);
  const std::vector<Handle> renewed = engine.insert(keys, std::span(boxes).subspan(1000));
  for (std::size_t i = 0; i < old.size(); ++i) ASSERT_EQ(engine.find(i) == old[i], i < 1000) << i;
  ASSERT_THROW(engine.update(old[2000], box_of(1, 1)), std::invalid_argument);
  engine.erase(engine.find(5).value());
  engine.erase(renewed);
  engine.step();
  engine.validate();
  EXPECT_EQ(engine.size(), 999u);
}

}  // namespace
}  // namespace sweepgrid::bulk_calls_test
