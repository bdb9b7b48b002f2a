// What the public interface promises beside the right events: errors that change nothing, handles, keys, settings,
// statistics, and calls from many threads.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "engine_oracle.hpp"

namespace sweepgrid {
namespace {

using Engine2 = Engine<float, 2>;
using Box2 = Box<float, 2>;
using Config2 = Config<float, 2>;
using Pairs = std::vector<Pair<std::uint64_t>>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

Config2 serial() {
  Config2 config;
  config.threads = 1;
  return config;
}

Box2 square(float x, float y, float width = 1) { return Box2({x, y}, {x + width, y + width}); }

/// What the call says when it throws std::invalid_argument; fails when it does not.
std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another exception: " << error.what();
    return {};
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

::testing::AssertionResult has(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "'" << text << "' does not say '" << part << "'";
}

static_assert(!std::is_copy_constructible_v<Engine2> && !std::is_move_constructible_v<Engine2>);

// ---- bad input

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

TEST(Engine, EmptyBulkCallsDoNothing) {
  Engine2 engine(serial());
  EXPECT_TRUE(engine.insert(std::span<const std::uint64_t>(), std::span<const Box2>()).empty());
  engine.update(std::span<const Handle>(), std::span<const Box2>());
  engine.erase(std::span<const Handle>());
  EXPECT_EQ(engine.step(), Events<std::uint64_t>{});
}

// ---- settings

TEST(EngineConfig, RefusesWhatIsOutOfRangeAndNamesIt) {
  const auto refused = [](const std::function<void(Config2&)>& change) {
    Config2 config = serial();
    change(config);
    return refusal([&] { Engine2 engine(config); });
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const int population : {0, -1, std::numeric_limits<int>::min()}) {
    EXPECT_TRUE(has(refused([&](Config2& c) { c.cell_population = population; }), "cell_population"));
  }
  for (const double size : {0.0, -0.0, -1.0, nan, infinity, -infinity}) {
    EXPECT_TRUE(has(refused([&](Config2& c) { c.cell_size = size; }), "cell_size"));
  }
  EXPECT_TRUE(has(refused([](Config2& c) { c.threads = -1; }), "threads"));
  EXPECT_TRUE(has(refused([](Config2& c) {
                    c.cell.kind = CellKind::kSegmented;
                    c.cell.segment_capacity = 3;
                  }),
                  "segment_capacity"));
  EXPECT_TRUE(has(refused([](Config2& c) { c.cell.kind = static_cast<CellKind>(17); }), "kind"));
}

TEST(EngineConfig, AGivenCellSizeIsKeptButForBoundedGridsOfTooManyCells) {
  for (const Reduction reduction : {Reduction::kSingleReporter, Reduction::kWitnessCounts}) {
    Config2 config = serial();
    config.cell_size = 1e-9;
    config.reduction = reduction;
    Engine2 engine(config);
    for (std::uint64_t key = 0; key < 100; ++key) engine.insert(key, square(static_cast<float>(key), 0, 0));
    EXPECT_TRUE(engine.step().begins.empty());
    engine.validate();
    if (reduction == Reduction::kSingleReporter) {
      EXPECT_EQ(engine.stats().cell_size, 1e-9);
    } else {
      EXPECT_GE(engine.stats().cell_size, 100.0 / (1 << 24));
      EXPECT_LT(engine.stats().cell_size, 300.0 / (1 << 24));
    }
  }
}

TEST(EngineConfig, AnExecutorMayServeManyEngines) {
  Config2 config;
  config.executor = make_executor(3);
  Engine2 first(config);
  Engine2 second(config);
  for (std::uint64_t key = 0; key < 100; ++key) {
    first.insert(key, square(0.5F * key, 0));
    second.insert(key, square(0.5F * key, 0));
  }
  Events<std::uint64_t> events_of_first;
  std::thread other([&] { events_of_first = first.step(); });
  const auto events_of_second = second.step();
  other.join();
  EXPECT_EQ(events_of_first, events_of_second);
  EXPECT_EQ(events_of_second.begins.size(), 99u + 98u);
}

TEST(EngineConfig, ScenesOfEveryScaleWork) {
  for (const double unit : {5e-324, 1e-300, 1e-200, 1e-30, 1e30, 1e200, 1e307}) {
    Config<double, 2> config;
    config.threads = 1;
    config.cell_population = 1;
    Engine<double, 2> engine(config);
    for (std::uint64_t i = 0; i < 10; ++i) {
      const double x = static_cast<double>(i);
      engine.insert(i, Box<double, 2>({x * unit, 0}, {(x + 1) * unit, unit}));
    }
    EXPECT_EQ(engine.step().begins.size(), 9u) << unit;
    engine.validate();
  }
}

// ---- handles, keys and boxes

TEST(Engine, HandlesAreGoodAtOnceAndBoxesAreTheLastGiven) {
  Engine2 engine(serial());
  const Handle handle = engine.insert(5, square(0, 0));
  EXPECT_EQ(engine.key(handle), 5u);
  EXPECT_EQ(engine.box(handle), square(0, 0));
  EXPECT_EQ(engine.find(5), handle);
  engine.update(handle, square(1, 1));
  EXPECT_EQ(engine.box(handle), square(1, 1));
  engine.step();
  EXPECT_EQ(engine.box(handle), square(1, 1));
  engine.update(handle, square(2, 2));
  EXPECT_EQ(engine.box(handle), square(2, 2));
}

TEST(Engine, BulkInsertReturnsHandlesInOrder) {
  Engine2 engine(serial());
  const std::vector<std::uint64_t> keys{9, 3, 7};
  const auto handles = engine.insert(keys, std::vector<Box2>(3, square(0, 0)));
  ASSERT_EQ(handles.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(engine.key(handles[i]), keys[i]);
}

TEST(Engine, SizeCountsWhatIsQueued) {
  Engine2 engine(serial());
  engine.insert(1, square(0, 0));
  engine.insert(2, square(0, 0));
  EXPECT_EQ(engine.size(), 2u);
  engine.step();
  engine.erase(std::uint64_t{1});
  EXPECT_EQ(engine.size(), 1u);
  EXPECT_FALSE(engine.contains(1));
  engine.insert(1, square(0, 0));
  EXPECT_EQ(engine.size(), 2u);
}

TEST(Engine, PairsAreThoseOfTheLatestStepWhateverIsQueued) {
  Engine2 engine(serial());
  for (const std::uint64_t key : {3, 1, 2}) engine.insert(key, square(0, 0));
  engine.step();
  const Pairs pairs{{1, 2}, {1, 3}, {2, 3}};
  EXPECT_EQ(engine.pairs(), pairs);
  engine.erase(std::uint64_t{1});
  engine.update(std::uint64_t{2}, square(50, 50));
  engine.insert(1, square(90, 90));
  engine.insert(0, square(0, 0));
  EXPECT_EQ(engine.pairs(), pairs);
}

TEST(Engine, AKeyThatIsErasedAndInsertedEndsItsOldPairsAndBeginsItsNew) {
  Engine2 engine(serial());
  for (const std::uint64_t key : {1, 2, 3}) engine.insert(key, square(key == 3 ? 9.0F : 0.0F, 0));
  engine.step();
  const Handle old = engine.find(1).value();
  engine.erase(old);
  const Handle renewed = engine.insert(1, square(0, 0));
  EXPECT_NE(old, renewed);
  const auto& events = engine.step();
  EXPECT_EQ(events.ends, (Pairs{{1, 2}}));
  EXPECT_EQ(events.begins, (Pairs{{1, 2}}));
  engine.validate();
}

TEST(Engine, AnObjectThatLivesForNoStepLeavesNoTrace) {
  Engine2 engine(serial());
  engine.insert(1, square(0, 0));
  engine.step();
  engine.insert(2, square(0, 0));
  engine.update(std::uint64_t{2}, square(0.5F, 0));
  engine.erase(std::uint64_t{2});
  EXPECT_EQ(engine.step(), Events<std::uint64_t>{});
  const StepCounters& counters = engine.stats().step;
  EXPECT_EQ(counters.inserts + counters.updates + counters.erases + counters.cell_ops, 0u);
  engine.validate();
}

TEST(Engine, EventsStayUntilTheNextStep) {
  Engine2 engine(serial());
  engine.insert(1, square(0, 0));
  engine.insert(2, square(0, 0));
  const auto& events = engine.step();
  const auto copy = events;
  engine.erase(std::uint64_t{1});
  engine.insert(3, square(0, 0));

  EXPECT_EQ(events, copy);
  EXPECT_EQ(&engine.step(), &events);
  EXPECT_EQ(events.ends, (Pairs{{1, 2}}));
  EXPECT_EQ(events.begins, (Pairs{{2, 3}}));
  EXPECT_EQ(engine.step(), Events<std::uint64_t>{});
}

TEST(Engine, BoxesThatTouchOverlap) {
  Engine2 engine(serial());
  engine.insert(1, Box2({0, 0}, {1, 1}));
  engine.insert(2, Box2({1, 1}, {2, 2}));
  engine.insert(3, Box2({1, std::nextafter(1.0F, 2.0F)}, {1, 2}));
  engine.insert(4, Box2({-0.0F, -0.0F}, {-0.0F, -0.0F}));
  EXPECT_EQ(engine.step().begins, (Pairs{{1, 2}, {1, 4}, {2, 3}}));
}

// ---- kinds of keys

template <class Key, class EngineType, class Model>
void expect_sorted_events_of(const std::vector<Key>& keys) {
  Config2 config;
  config.threads = 2;
  EngineType engine(config);
  Model model;
  oracle::Random random(3);
  const auto anywhere = [&] {
    return square(static_cast<float>(random.below(8)), static_cast<float>(random.below(8)), 2);
  };
  for (int step = 0; step < 12; ++step) {
    for (const Key& key : keys) {
      const Box2 box = anywhere();
      if (!engine.contains(key)) {
        engine.insert(key, box), model.insert(key, box);
      } else if (random.percent(20)) {
        engine.erase(key), model.erase(key);
        if (random.percent(50)) engine.insert(key, box), model.insert(key, box);
      } else {
        engine.update(key, box), model.update(key, box);
      }
    }
    ASSERT_EQ(oracle::difference(model.step(), engine.step()), "");
    ASSERT_EQ(oracle::compare(engine, model), "");
  }
}

TEST(EngineKeys, MayBeStrings) {
  std::vector<std::string> keys;
  for (int i = 0; i < 40; ++i)
    keys.push_back(std::string(static_cast<std::size_t>(i), 'x') + std::to_string(i * 37 % 40));
  expect_sorted_events_of<std::string, Engine<float, 2, std::string>, oracle::EngineModel<float, 2, std::string>>(keys);

  Engine<float, 2, std::string> engine(serial());
  const Handle ball = engine.insert("ball", square(0, 0));
  EXPECT_TRUE(has(refusal([&] { engine.update(ball, Box2({0, 0}, {kNan, 0})); }), "ball"));
  EXPECT_TRUE(has(refusal([&] { engine.insert("ball", square(0, 0)); }), "ball"));
  EXPECT_TRUE(has(refusal([&] { engine.erase(std::string("wall")); }), "wall"));
}

TEST(EngineKeys, MayBeNegative) {
  std::vector<int> keys;
  for (int i = -20; i < 20; ++i) keys.push_back(i * 1000);
  expect_sorted_events_of<int, Engine<float, 2, int>, oracle::EngineModel<float, 2, int>>(keys);
}

struct Part {
  std::string body;
  int index = 0;
  friend bool operator==(const Part&, const Part&) = default;
};
struct PartHash {
  std::size_t operator()(const Part& part) const { return static_cast<std::size_t>(part.index); }  // collides a lot
};
/// By descending index, then by name.
struct PartOrder {
  bool operator()(const Part& a, const Part& b) const {
    return a.index != b.index ? a.index > b.index : a.body < b.body;
  }
};

TEST(EngineKeys, MayBeStructsWithTheirOwnHashAndOrder) {
  std::vector<Part> keys;
  for (int i = 0; i < 40; ++i) keys.push_back({std::string(1, static_cast<char>('a' + i % 7)), i / 7});
  using PartEngine = Engine<float, 2, Part, PartHash, PartOrder>;
  expect_sorted_events_of<Part, PartEngine, oracle::EngineModel<float, 2, Part, PartOrder>>(keys);

  PartEngine engine(serial());
  engine.insert(keys[0], square(0, 0));
  EXPECT_TRUE(has(refusal([&] { engine.insert(keys[0], square(0, 0)); }), "insert of object"));
}

TEST(EngineKeys, MayBeBoxedByEigen) {
  Engine<double, 3> engine;
  using EigenBox = Eigen::AlignedBox3d;
  engine.insert(1, EigenBox(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 1, 1)));
  const Handle second = engine.insert(2, EigenBox(Eigen::Vector3d(2, 0, 0), Eigen::Vector3d(3, 1, 1)));
  EXPECT_TRUE(engine.step().begins.empty());
  engine.update(second, EigenBox(Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(3, 1, 1)));
  EXPECT_EQ(engine.step().begins, (Pairs{{1, 2}}));
  EXPECT_TRUE(has(refusal([&] { engine.update(second, EigenBox()); }), "min > max"));  // Eigen's empty box
  Engine<float, 2> flat;
  const Handle dynamic = flat.insert(1, Eigen::AlignedBox<float, 2>(Eigen::Vector2f(-1, -1), Eigen::Vector2f(1, 1)));
  EXPECT_EQ(flat.box(dynamic), Box2({-1, -1}, {1, 1}));
}

// ---- statistics

TEST(EngineStats, CountWhatHappened) {
  Config2 config = serial();
  config.cell.kind = CellKind::kBatch;
  config.cell_size = 10;
  Engine2 engine(config);
  engine.insert(1, square(5, 5, 0));  // points, so that each is in one cell, wherever the grid begins
  engine.insert(2, square(5, 5, 0));
  engine.insert(3, square(105, 5, 0));
  engine.step();
  Stats stats = engine.stats();
  EXPECT_EQ(stats.steps, 1u);
  EXPECT_EQ(stats.objects, 3u);
  EXPECT_EQ(stats.pairs, 1u);
  EXPECT_EQ(stats.grids, 1u);
  EXPECT_EQ(stats.cells, 2u);
  EXPECT_EQ(stats.cell_size, 10);
  EXPECT_EQ(stats.step.inserts, 3u);
  EXPECT_EQ(stats.step.cell_ops, 3u);
  EXPECT_EQ(stats.step.cells_drained, 2u);
  EXPECT_EQ(stats.step.begins, 1u);
  EXPECT_EQ(stats.step.cells.deltas, 1u);
  EXPECT_GT(stats.bytes_objects, 0u);
  EXPECT_GT(stats.bytes_cells, 0u);
  EXPECT_EQ(stats.bytes_witnesses, 0u);

  engine.update(std::uint64_t{1}, square(35, 5, 0));  // migrates: one erase, one insert
  engine.update(std::uint64_t{2}, square(5, 5, 0));   // rests
  engine.erase(std::uint64_t{3});
  engine.step();
  stats = engine.stats();
  EXPECT_EQ(stats.steps, 2u);
  EXPECT_EQ(stats.step.inserts, 0u);
  EXPECT_EQ(stats.step.updates, 1u);
  EXPECT_EQ(stats.step.migrations, 1u);
  EXPECT_EQ(stats.step.erases, 1u);
  EXPECT_EQ(stats.step.cell_ops, 2u + 1u);
  EXPECT_EQ(stats.step.ends, 1u);
  EXPECT_EQ(stats.cells, 2u);
  EXPECT_EQ(stats.total.inserts, 3u);
  EXPECT_EQ(stats.total.begins, 1u);
  EXPECT_EQ(stats.total.ends, 1u);
  EXPECT_EQ(stats.step.regrids, 0u);

  engine.step();
  EXPECT_EQ(engine.stats().step, StepCounters{});
  EXPECT_EQ(engine.stats().steps, 3u);
}

TEST(EngineStats, GridsAreMadeForSizesThatExistAndGoWithThem) {
  Config2 config = serial();
  config.cell_size = 1;
  Engine2 engine(config);
  for (std::uint64_t key = 0; key < 10; ++key) engine.insert(key, square(static_cast<float>(3 * key), 0));
  engine.step();
  EXPECT_EQ(engine.stats().grids, 1u);
  const Handle wide = engine.insert(10, square(0, 0, 30));
  EXPECT_EQ(engine.step().begins.size(), 10u);
  EXPECT_EQ(engine.stats().grids, 2u);
  const Handle endless = engine.insert(11, Box2({-kInfinity, 0}, {kInfinity, 0}));
  EXPECT_EQ(engine.step().begins.size(), 11u);
  EXPECT_EQ(engine.stats().grids, 3u);
  engine.erase(wide);
  engine.erase(endless);
  EXPECT_EQ(engine.step().ends.size(), 21u);
  EXPECT_EQ(engine.stats().grids, 1u);
  EXPECT_EQ(engine.stats().cell_size, 1);
}

TEST(EngineStats, OnlyWitnessCountsKeepATableOfPairs) {
  for (const Reduction reduction : {Reduction::kSingleReporter, Reduction::kWitnessCounts}) {
    Config2 config = serial();
    config.reduction = reduction;
    Engine2 engine(config);
    for (std::uint64_t key = 0; key < 50; ++key) engine.insert(key, square(0, 0));
    engine.step();
    EXPECT_EQ(engine.stats().pairs, 50u * 49 / 2);
    EXPECT_EQ(engine.stats().bytes_witnesses > 0, reduction == Reduction::kWitnessCounts);
    EXPECT_EQ(engine.pairs().size(), 50u * 49 / 2);
  }
}

TEST(EngineStats, AGrowingSceneMakesTheGridAnewOnce) {
  for (const Reduction reduction : {Reduction::kSingleReporter, Reduction::kWitnessCounts}) {
    Config2 config = serial();
    config.reduction = reduction;
    Engine2 engine(config);
    for (std::uint64_t key = 0; key < 10; ++key) engine.insert(key, square(static_cast<float>(20 * key), 0));
    engine.step();
    EXPECT_EQ(engine.stats().step.regrids, 1u);
    const std::size_t cells = engine.stats().cells;
    for (std::uint64_t key = 10; key < 5000; ++key) {
      engine.insert(key, square(static_cast<float>(key % 70) * 3, static_cast<float>(key / 70) * 3));
    }
    engine.step();
    EXPECT_EQ(engine.stats().step.regrids, 1u);
    EXPECT_GT(engine.stats().cells, 2 * cells);
    engine.step();
    EXPECT_EQ(engine.stats().step.regrids, 0u);
  }
}

/// 2000 objects in a square of that edge, centred at `centre`.
void queue_square(Engine2& engine, float centre, float edge) {
  oracle::Random random(1);
  for (std::uint64_t key = 0; key < 2000; ++key) {
    const auto place = [&] { return centre + edge * (static_cast<float>(random.below(1000)) / 1000 - 0.5F); };
    const float x = place();
    const Box2 box = square(x, place(), edge / 1000);
    if (engine.contains(key)) {
      engine.update(key, box);
    } else {
      engine.insert(key, box);
    }
  }
}

TEST(EngineStats, ASceneThatCollapsesGetsSmallerCells) {
  for (const Reduction reduction : {Reduction::kSingleReporter, Reduction::kWitnessCounts}) {
    Config2 config = serial();
    config.reduction = reduction;
    Engine2 engine(config);
    float edge = 1024;
    queue_square(engine, 0, edge);
    engine.step();
    const double size = engine.stats().cell_size;
    for (; edge > 1; edge /= 2) {
      queue_square(engine, 0, edge);
      engine.step();
    }
    for (int step = 0; step < 8; ++step) {  // if it still follows
      queue_square(engine, 0.01F * static_cast<float>(step % 2), edge);
      engine.step();
    }
    EXPECT_LT(engine.stats().cell_size, size / 512);
    EXPECT_GT(engine.stats().cell_size, size / 2048);
    EXPECT_LT(engine.stats().total.regrids, 8u);
  }
}

TEST(EngineStats, ASceneThatLeavesItsPlaceKeepsItsCells) {
  Config2 config = serial();
  for (const Reduction reduction : {Reduction::kSingleReporter, Reduction::kWitnessCounts}) {
    config.reduction = reduction;
    Engine2 engine(config);
    queue_square(engine, 0, 100);
    engine.step();
    const std::size_t cells = engine.stats().cells;
    for (int step = 0; step < 3; ++step) {
      queue_square(engine, 5000.0F + static_cast<float>(step), 100);
      engine.step();
    }
    EXPECT_GT(engine.stats().cells, cells / 2);
    // A grid without bounds serves everywhere; one with bounds is made anew where the scene is now.
    EXPECT_EQ(engine.stats().total.regrids, reduction == Reduction::kSingleReporter ? 1u : 2u);
  }
}

TEST(EngineStats, ASceneThatStaysKeepsItsGrid) {
  Engine2 engine(serial());
  for (int step = 0; step < 20; ++step) {
    queue_square(engine, static_cast<float>(step % 3), 100);
    engine.step();
  }
  EXPECT_EQ(engine.stats().total.regrids, 1u);
}

/// A key that sometimes cannot be stored.
struct FragileKey {
  int number = 0;
  bool fragile = false;

  FragileKey() = default;
  explicit FragileKey(int n, bool f = false) : number(n), fragile(f) {}
  FragileKey(const FragileKey&) = default;
  FragileKey& operator=(const FragileKey& other) {
    if (other.fragile) throw std::runtime_error("does not copy");
    number = other.number;
    return *this;
  }
  friend bool operator==(const FragileKey& a, const FragileKey& b) { return a.number == b.number; }
  friend bool operator<(const FragileKey& a, const FragileKey& b) { return a.number < b.number; }
};

struct FragileHash {
  std::size_t operator()(const FragileKey& key) const { return static_cast<std::size_t>(key.number); }
};

TEST(EngineKeys, AKeyThatCannotBeStoredLeavesNoObject) {
  Engine<float, 2, FragileKey, FragileHash> engine(serial());
  engine.insert(FragileKey(1), square(0, 0));
  EXPECT_THROW(engine.insert(FragileKey(2, true), square(0, 0)), std::runtime_error);
  EXPECT_EQ(engine.size(), 1u);
  EXPECT_FALSE(engine.contains(FragileKey(2)));
  EXPECT_TRUE(engine.step().begins.empty());
  engine.insert(FragileKey(2), square(0, 0));
  EXPECT_EQ(engine.step().begins.size(), 1u);
  engine.validate();
}

TEST(EngineStats, ACrowdThatMovesOnlySometimesKeepsItsGrid) {
  Engine2 engine(serial());
  constexpr int kCold = 2000;
  constexpr int kHot = 400;
  const auto box_of = [](int object, int step) {
    const auto shift = static_cast<float>(step % 2) * 1e-4F;
    if (object >= kCold) return square(500 + static_cast<float>(object - kCold) * 1e-5F + shift, 500);
    return square(static_cast<float>(object * 37 % 1000) + shift, static_cast<float>(object * 61 % 1009));
  };
  for (int object = 0; object < kCold + kHot; ++object) engine.insert(object, box_of(object, 0));
  engine.step();
  for (int step = 1; step < 30; ++step) {
    const bool hot = step % 3 == 0;
    for (int object = hot ? kCold : 0; object < (hot ? kCold + kHot : kCold); ++object) {
      engine.update(object, box_of(object, step));
    }
    engine.step();
  }
  EXPECT_LE(engine.stats().total.regrids, 2u);
}

TEST(EngineStats, AnIdleStepTookNoTime) {
  Engine2 engine(serial());
  engine.insert(1, square(0, 0));
  engine.step();
  engine.step();
  for (const StageTime& stage : engine.stats().stages) EXPECT_EQ(stage.seconds, 0);
}

TEST(EngineStats, TasksAreRecordedOnDemand) {
  Engine2 engine(serial());
  engine.insert(1, square(0, 0));
  engine.step();
  EXPECT_TRUE(engine.tasks().empty());
  engine.record_tasks(true);
  engine.insert(2, square(0, 0));
  engine.step();
  EXPECT_FALSE(engine.tasks().empty());
  EXPECT_EQ(engine.stage_names().size(), engine.stats().stages.size());
  for (const TaskRecord& task : engine.tasks()) EXPECT_LT(task.stage, engine.stage_names().size());
}

// ---- many threads

TEST(EngineConcurrency, QueueingFromManyThreadsIsTheSameAsFromOne) {
  constexpr std::uint64_t kWorkers = 8;
  constexpr std::uint64_t kEach = oracle::kSanitized ? 150 : 400;
  for (const int threads : {1, 3}) {
    Config2 config;
    config.threads = threads;
    Engine2 engine(config);
    oracle::EngineModel<float, 2> model;
    for (std::uint64_t step = 0; step < 6; ++step) {
      const auto box_of = [&](std::uint64_t key) {
        oracle::Random random(1000 * step + key);
        return square(static_cast<float>(random.below(1000)) / 10, static_cast<float>(random.below(1000)) / 10);
      };
      const auto each = [&](std::uint64_t worker, const auto& insert, const auto& update, const auto& erase) {
        for (std::uint64_t i = 0; i < kEach; ++i) {
          const std::uint64_t key = i * kWorkers + worker;  // neighbours belong to different threads
          const std::uint64_t phase = (key / kWorkers + step) % 5;
          if (step == 0)
            insert(key, box_of(key));
          else if (phase == 1)
            erase(key);
          else if (phase == 2 && step > 1)
            insert(key, box_of(key));
          else if (phase != 2)
            update(key, box_of(key));
        }
      };
      std::vector<std::thread> workers;
      for (std::uint64_t worker = 0; worker < kWorkers; ++worker) {
        workers.emplace_back([&, worker] {
          each(
              worker, [&](auto key, const Box2& box) { engine.insert(key, box); },
              [&](auto key, const Box2& box) { engine.update(key, box); }, [&](auto key) { engine.erase(key); });
        });
      }
      for (std::thread& worker : workers) worker.join();
      for (std::uint64_t worker = 0; worker < kWorkers; ++worker) {
        each(
            worker, [&](auto key, const Box2& box) { model.insert(key, box); },
            [&](auto key, const Box2& box) { model.update(key, box); }, [&](auto key) { model.erase(key); });
      }
      ASSERT_EQ(oracle::difference(model.step(), engine.step()), "") << "step " << step;
      ASSERT_EQ(oracle::compare(engine, model), "") << "step " << step;
    }
  }
}

TEST(EngineConcurrency, BulkCallsFromManyThreads) {
  Engine2 engine(serial());
  oracle::EngineModel<float, 2> model;
  std::vector<std::thread> workers;
  for (std::uint64_t worker = 0; worker < 4; ++worker) {
    workers.emplace_back([&engine, worker] {
      std::vector<std::uint64_t> keys;
      std::vector<Box2> boxes;
      for (std::uint64_t i = 0; i < 300; ++i) {
        keys.push_back(i * 4 + worker);
        boxes.push_back(square(static_cast<float>(keys.back() % 40), static_cast<float>(keys.back() / 40)));
      }
      const std::vector<Handle> handles = engine.insert(keys, boxes);
      EXPECT_THROW(engine.insert(keys, boxes), std::invalid_argument);
      for (Box2& box : boxes) box.max[0] += 0.5F;
      engine.update(handles, boxes);
      engine.erase(std::span(handles).subspan(0, 50));
    });
  }
  for (std::thread& worker : workers) worker.join();
  for (std::uint64_t key = 200; key < 1200; ++key) {
    Box2 box = square(static_cast<float>(key % 40), static_cast<float>(key / 40));
    box.max[0] += 0.5F;
    model.insert(key, box);
  }
  ASSERT_EQ(oracle::difference(model.step(), engine.step()), "");
  ASSERT_EQ(oracle::compare(engine, model), "");
}

}  // namespace
}  // namespace sweepgrid
