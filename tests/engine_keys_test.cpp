// Kinds of keys.
#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "engine_client.hpp"

namespace sweepgrid::engine_keys_test {
namespace {

template <class Key, class EngineType, class Model>
void expect_sorted_events_of(const std::vector<Key>& keys) {
  Config config;
  config.threads = 2;
  config.parallel_from = 0;
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
  // What would be rounded or cut off on the way does not compile.
  static_assert(!std::is_convertible_v<EigenBox, Engine<std::int16_t, 3>::BoxType>);
  static_assert(!std::is_convertible_v<EigenBox, Engine<float, 3>::BoxType>);
  static_assert(std::is_convertible_v<Eigen::AlignedBox3f, Engine<double, 3>::BoxType>);
}

TEST(EngineKeys, ABoxIsNotNarrowedWithoutAWord) {
  static_assert(std::is_constructible_v<Box<double, 3>, Eigen::AlignedBox3d>);
  static_assert(std::is_constructible_v<Box<double, 3>, Eigen::AlignedBox3f>);
  static_assert(!std::is_constructible_v<Box<float, 3>, Eigen::AlignedBox3d>);
  static_assert(!std::is_constructible_v<Box<std::int16_t, 3>, Eigen::AlignedBox3d>);
  static_assert(!std::is_constructible_v<Box<std::int16_t, 3>, Eigen::AlignedBox<std::int32_t, 3>>);
}

/// A key that cannot be made of nothing, and that tells how many of it live.
struct Ticket {
  explicit Ticket(int n) : number(n) { ++living; }
  Ticket(const Ticket& other) : number(other.number) { ++living; }
  Ticket& operator=(const Ticket&) = delete;
  ~Ticket() { --living; }
  friend bool operator==(const Ticket& a, const Ticket& b) { return a.number == b.number; }
  friend bool operator<(const Ticket& a, const Ticket& b) { return a.number < b.number; }

  const int number;
  static inline std::atomic<int> living = 0;
};
struct TicketHash {
  std::size_t operator()(const Ticket& ticket) const { return static_cast<std::size_t>(ticket.number); }
};

TEST(EngineKeys, NeedNeitherADefaultConstructorNorAssignment) {
  for (const int threads : {1, 3}) {
    Config config;
    config.threads = threads;
    config.parallel_from = 0;
    Engine<float, 2, Ticket, TicketHash> engine(config);
    std::vector<Ticket> tickets;
    std::vector<Box2> boxes;
    for (int i = 0; i < 3000; ++i) {
      tickets.emplace_back(i * 7 % 3000);
      boxes.push_back(square(static_cast<float>(i * 7 % 3000), 0, 1));
    }
    const auto handles = engine.insert(tickets, boxes);
    const auto& events = engine.step();
    ASSERT_EQ(events.begins.size(), 2999u);
    for (int i = 0; i < 2999; ++i) {
      ASSERT_EQ(events.begins[static_cast<std::size_t>(i)].first.number, i);
      ASSERT_EQ(events.begins[static_cast<std::size_t>(i)].second.number, i + 1);
    }
    EXPECT_EQ(engine.pairs().size(), 2999u);
    EXPECT_EQ(engine.key(handles[2]).number, 14);
    engine.validate();
  }
}

TEST(EngineKeys, LiveAsLongAsTheirObjectsAndEvents) {
  {
    Engine<float, 2, Ticket, TicketHash> engine(serial());
    const Handle first = engine.insert(Ticket(1), square(0, 0));
    engine.insert(Ticket(2), square(0, 0));
    engine.insert(Ticket(3), square(50, 0));
    EXPECT_EQ(Ticket::living, 3);
    EXPECT_THROW(engine.insert(Ticket(2), square(0, 0)), std::invalid_argument);
    EXPECT_EQ(Ticket::living, 3);
    engine.step();
    EXPECT_EQ(Ticket::living, 3 + 2);  // a begin
    engine.erase(first);
    engine.insert(Ticket(4), square(90, 0));
    engine.erase(Ticket(4));  // leaves no trace
    EXPECT_EQ(Ticket::living, 4 + 2);
    EXPECT_EQ(engine.step().ends.size(), 1u);
    EXPECT_EQ(Ticket::living, 2 + 2);  // the end tells of the erased one
    engine.step();
    EXPECT_EQ(Ticket::living, 2);
    std::vector<Ticket> tickets;
    tickets.emplace_back(5);
    tickets.emplace_back(3);
    EXPECT_THROW(engine.insert(tickets, std::vector<Box2>(2, square(0, 0))), std::invalid_argument);
    tickets.clear();
    EXPECT_EQ(Ticket::living, 2);
  }
  EXPECT_EQ(Ticket::living, 0);
}

/// An order that tells keys apart by their tens only.
struct ByTens {
  bool operator()(int a, int b) const { return a / 10 < b / 10; }
};

TEST(EngineKeys, WhoseOrderTiesAreRefusedByNameAndTheStepIsTakenBack) {
  for (const Reduction reduction : {Reduction::kSingleReporter, Reduction::kWitnessCounts}) {
    for (const int threads : {1, 3}) {
      Config config;
      config.threads = threads;
      config.parallel_from = 0;
      config.reduction = reduction;
      Engine<float, 2, int, std::hash<int>, ByTens> engine(config);
      engine.insert(10, square(0, 0));
      engine.insert(20, square(0, 0));
      EXPECT_EQ(engine.step().begins, (std::vector<Pair<int>>{{10, 20}}));
      engine.insert(25, square(0, 0));
      for (int again = 0; again < 2; ++again) {
        const std::string text = refusal([&] { engine.step(); });
        EXPECT_TRUE(has(text, "object 20")) << text;
        EXPECT_TRUE(has(text, "object 25")) << text;
        EXPECT_EQ(engine.pairs(), (std::vector<Pair<int>>{{10, 20}}));
        EXPECT_EQ(engine.size(), 3u);
      }
      engine.erase(20);
      const auto& events = engine.step();
      EXPECT_EQ(events.ends, (std::vector<Pair<int>>{{10, 20}}));
      EXPECT_EQ(events.begins, (std::vector<Pair<int>>{{10, 25}}));
    }
  }
}

/// A hash that fails when it is told to.
struct FailingHash {
  static inline int left = -1;  // calls until it fails; negative: it does not
  std::size_t operator()(std::uint64_t key) const {
    if (left >= 0 && left-- == 0) throw std::runtime_error("does not hash");
    return static_cast<std::size_t>(key);
  }
};

TEST(EngineKeys, AHashThatFailsLeavesBulkCallsUndone) {
  constexpr std::size_t kCount = 3;
  for (const bool envelopes : {false, true}) {
    Config config = serial();
    if (envelopes) config.envelope = EnvelopeOptions{.margin = 1};
    Engine<float, 2, std::uint64_t, FailingHash> engine(config);
    const std::vector<std::uint64_t> keys{0, 1, 2};
    const std::vector<Box2> boxes(kCount, square(0, 0));
    for (int calls = 0; calls < static_cast<int>(kCount); ++calls) {
      FailingHash::left = calls;
      EXPECT_THROW(engine.insert(keys, boxes), std::runtime_error);
      FailingHash::left = -1;
      EXPECT_EQ(engine.size(), 0u);
      for (const std::uint64_t key : keys) EXPECT_FALSE(engine.contains(key));
    }
    const auto handles = engine.insert(keys, boxes);
    EXPECT_EQ(engine.step().begins.size(), 3u);
    FailingHash::left = 0;  // nothing is asked of keys
    engine.erase(handles);
    FailingHash::left = -1;
    EXPECT_EQ(engine.size(), 0u);
    EXPECT_EQ(engine.step().ends.size(), 3u);
    engine.validate();
  }
}

/// A key that sometimes cannot be stored.
struct FragileKey {
  int number = 0;
  bool fragile = false;

  FragileKey() = default;
  explicit FragileKey(int n, bool f = false) : number(n), fragile(f) {}
  FragileKey(const FragileKey& other) : number(other.number) {
    if (other.fragile) throw std::runtime_error("does not copy");
  }
  FragileKey& operator=(const FragileKey&) = default;
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

  std::vector<FragileKey> keys{FragileKey(3), FragileKey(4)};
  keys.emplace_back(5);
  keys[1].fragile = true;
  EXPECT_THROW(engine.insert(keys, std::vector<Box2>(3, square(0, 0))), std::runtime_error);
  EXPECT_EQ(engine.size(), 2u);
  EXPECT_FALSE(engine.contains(FragileKey(3)));
  EXPECT_TRUE(engine.step().begins.empty());
}

}  // namespace
}  // namespace sweepgrid::engine_keys_test
