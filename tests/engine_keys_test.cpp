// Kinds of keys.
#include <gtest/gtest.h>

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

namespace sweepgrid {
namespace {

template <class Key, class EngineType, class Model>
void expect_sorted_events_of(const std::vector<Key>& keys) {
  Config config;
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
  // What would be rounded or cut off on the way does not compile.
  static_assert(!std::is_convertible_v<EigenBox, Engine<std::int16_t, 3>::BoxType>);
  static_assert(!std::is_convertible_v<EigenBox, Engine<float, 3>::BoxType>);
  static_assert(std::is_convertible_v<Eigen::AlignedBox3f, Engine<double, 3>::BoxType>);
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

}  // namespace
}  // namespace sweepgrid
