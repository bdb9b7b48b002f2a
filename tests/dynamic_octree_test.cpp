#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "baselines/dynamic_octree.hpp"

namespace sweepgrid::baselines::dynamic_octree_test {
namespace {

using IdPair = std::pair<ObjectId, ObjectId>;

/// The octree beside all pairs by brute force. An object's life has a number, so that a key erased and inserted again
/// within a step is another object.
template <class Scalar>
class Model {
 public:
  using BoxType = Box<Scalar, 3>;

  explicit Model(int leaf_size = 4) : octree({leaf_size}) {}

  void insert(ObjectId object, const BoxType& box) {
    octree.insert(object, box);
    boxes[object] = {box, ++lives_};
  }
  void update(ObjectId object, const BoxType& box) {
    octree.update(object, box);
    boxes[object].first = box;
  }
  void erase(ObjectId object) {
    octree.erase(object);
    boxes.erase(object);
  }

  /// Steps, and expects events and structure to be right.
  void step() {
    std::map<IdPair, IdPair> now;  // pair to lives
    for (auto a = boxes.begin(); a != boxes.end(); ++a) {
      for (auto b = std::next(a); b != boxes.end(); ++b) {
        if (!a->second.first.overlaps(b->second.first)) continue;
        now[{a->first, b->first}] = {a->second.second, b->second.second};
      }
    }
    const std::vector<IdPair> begins = only_in(now, pairs_);
    const std::vector<IdPair> ends = only_in(pairs_, now);
    const Events<ObjectId>& events = octree.step();
    ASSERT_EQ(list(events.begins), begins);
    ASSERT_EQ(list(events.ends), ends);
    ASSERT_EQ(octree.size(), boxes.size());
    ASSERT_NO_THROW(octree.validate());
    pairs_ = std::move(now);
  }

  DynamicOctree<Scalar> octree;
  std::map<ObjectId, std::pair<BoxType, int>> boxes;

 private:
  using Lives = std::map<IdPair, IdPair>;

  static std::vector<IdPair> only_in(const Lives& from, const Lives& other) {
    std::vector<IdPair> missing;
    for (const auto& [pair, lives] : from) {
      const auto found = other.find(pair);
      if (found == other.end() || found->second != lives) missing.push_back(pair);
    }
    return missing;
  }

  static std::vector<IdPair> list(const std::vector<Pair<ObjectId>>& pairs) {
    std::vector<IdPair> listed;
    for (const auto& pair : pairs) listed.emplace_back(pair.first, pair.second);
    return listed;
  }

  Lives pairs_;
  int lives_ = 0;
};

/// What a random world does; widths and jumps in world units.
struct World {
  const char* name;
  int objects = 150;
  int steps = 12;
  double side = 20;
  double width = 1;
  double huge_share = 0;  // of objects, as wide as the world
  double jump = 0.2;
  double teleport_share = 0;
  double moving_share = 0.5;
  double churn_share = 0;
  double drift = 0;  // per step, of the whole world
  bool lattice = false;
};

void PrintTo(const World& world, std::ostream* out) { *out << world.name; }

constexpr World kWorlds[] = {
    {.name = "Calm"},
    {.name = "AllMove", .moving_share = 1},
    {.name = "Fast", .jump = 5},
    {.name = "Teleports", .teleport_share = 0.5},
    {.name = "Churn", .churn_share = 0.3},
    {.name = "Replaced", .churn_share = 1},
    {.name = "Ties", .side = 6, .jump = 2, .lattice = true},
    {.name = "Points", .side = 3, .width = 0, .jump = 2, .lattice = true},
    {.name = "OnePlace", .objects = 60, .side = 0, .width = 0, .jump = 0, .churn_share = 0.2},
    {.name = "HugeAmongSmall", .huge_share = 0.1, .teleport_share = 0.2, .churn_share = 0.1},
    {.name = "MostlyHuge", .objects = 60, .huge_share = 0.8},
    {.name = "Leaves", .drift = 15},
    {.name = "FarAway", .side = 1e30, .width = 1e29, .jump = 1e28},
    {.name = "Flat", .side = 1000, .width = 20, .jump = 3, .churn_share = 0.05},
};

template <class Scalar>
class RandomWorld {
 public:
  RandomWorld(const World& world, std::uint64_t seed) : world_(world), random_(seed), model(3) {
    for (int i = 0; i < world.objects; ++i) {
      model.insert(next_++, box());
    }
  }

  void step() {
    centre_ += world_.drift;
    std::vector<ObjectId> present;
    for (const auto& [object, box] : model.boxes) present.push_back(object);
    for (const ObjectId object : present) {
      if (chance(world_.churn_share)) {
        model.erase(object);
        model.insert(chance(0.5) ? object : next_++, box());
      }
      if (!model.boxes.contains(object) || !chance(world_.moving_share)) continue;
      if (chance(0.2)) model.update(object, box());  // the last one wins
      model.update(object, chance(world_.teleport_share) ? box() : moved(model.boxes[object].first));
    }
    model.step();
  }

 private:
  double between(double low, double high) {
    const double place = std::uniform_real_distribution<double>(0, 1)(random_) * (high - low) + low;
    return world_.lattice ? std::round(place) : place;
  }
  bool chance(double share) { return std::uniform_real_distribution<double>(0, 1)(random_) < share; }

  Box<Scalar, 3> box() {
    Box<Scalar, 3> box;
    const double width = chance(world_.huge_share) ? world_.side : world_.width;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = centre_ + between(0, world_.side);
      box.min[axis] = static_cast<Scalar>(low);
      box.max[axis] = static_cast<Scalar>(low + between(0, 2 * width));
    }
    return box;
  }

  Box<Scalar, 3> moved(Box<Scalar, 3> box) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto by = static_cast<Scalar>(between(-world_.jump, world_.jump) + world_.drift);
      box.min[axis] += by;
      box.max[axis] += by;
      // Now and then another size.
      if (chance(0.1)) box.max[axis] = std::max(box.min[axis], box.max[axis] + by);
    }
    return box;
  }

  World world_;
  std::mt19937_64 random_;
  double centre_ = 0;
  ObjectId next_ = 0;

 public:
  Model<Scalar> model;
};

class OctreeWorlds : public testing::TestWithParam<World> {};

template <class Scalar>
void play(const World& world, std::uint64_t seed) {
  RandomWorld<Scalar> random_world(world, seed);
  for (int step = 0; step < world.steps; ++step) {
    random_world.step();
    if (testing::Test::HasFatalFailure()) FAIL() << "at step " << step << " of seed " << seed;
  }
}

TEST_P(OctreeWorlds, FloatEventsAreThoseOfAllPairs) {
  for (const std::uint64_t seed : {1, 2, 3}) play<float>(GetParam(), seed);
}

TEST_P(OctreeWorlds, DoubleEventsAreThoseOfAllPairs) { play<double>(GetParam(), 4); }

INSTANTIATE_TEST_SUITE_P(Worlds, OctreeWorlds, testing::ValuesIn(kWorlds),
                         [](const auto& world) { return std::string(world.param.name); });

using BoxF = Box<float, 3>;

BoxF cube(float at, float width = 1) { return {{at, at, at}, {at + width, at + width, at + width}}; }

TEST(DynamicOctree, BoxesWithoutEndMeetEverything) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kMax = std::numeric_limits<float>::max();
  Model<float> model(2);
  for (ObjectId object = 0; object < 40; ++object) model.insert(object, cube(static_cast<float>(object) * 2));
  model.step();
  model.insert(100, {{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}});
  model.insert(101, {{kInfinity, 0, 0}, {kInfinity, 1, 1}});
  model.insert(102, {{-kInfinity, 0, 0}, {5, 1, 1}});
  model.insert(103, {{-kMax, -kMax, -kMax}, {kMax, kMax, kMax}});
  model.insert(104, {{kMax, kMax, kMax}, {kMax, kMax, kMax}});
  model.step();
  model.update(101, cube(3));
  model.update(3, {{kInfinity, kInfinity, kInfinity}, {kInfinity, kInfinity, kInfinity}});
  model.step();
  model.erase(100);
  model.step();
}

TEST(DynamicOctree, RootFollowsObjectsThatLeave) {
  Model<float> model(2);
  for (ObjectId object = 0; object < 64; ++object) model.insert(object, cube(static_cast<float>(object)));
  model.step();
  const std::uint64_t fitted = model.octree.counters().roots_fitted;
  for (ObjectId object = 0; object < 64; ++object) model.update(object, cube(1e6F + 0.5F * static_cast<float>(object)));
  model.step();
  EXPECT_EQ(model.octree.counters().roots_fitted, fitted + 1);
  for (ObjectId object = 0; object < 64; object += 9) model.update(object, cube(1e6F));
  model.step();
  EXPECT_EQ(model.octree.counters().roots_fitted, fitted + 1);
}

TEST(DynamicOctree, GivesNodesBackWhenObjectsGo) {
  Model<float> model(2);
  for (ObjectId object = 0; object < 200; ++object) model.insert(object, cube(static_cast<float>(object) / 4));
  model.step();
  const std::uint64_t split = model.octree.counters().nodes_split;
  EXPECT_GT(split, 20U);
  for (ObjectId object = 0; object < 200; ++object) model.erase(object);
  model.step();
  EXPECT_EQ(model.octree.counters().nodes_merged, split);
  EXPECT_EQ(model.octree.size(), 0U);
}

TEST(DynamicOctree, SmallMovesStayWhereTheyAre) {
  Model<float> model(4);
  for (ObjectId object = 0; object < 300; ++object) model.insert(object, cube(3 * static_cast<float>(object), 0.5F));
  model.step();
  const OctreeCounters before = model.octree.counters();
  for (ObjectId object = 0; object < 300; ++object) model.update(object, cube(3 * static_cast<float>(object), 0.51F));
  model.step();
  EXPECT_EQ(model.octree.counters().moves - before.moves, 300U);
  EXPECT_LT(model.octree.counters().relocations - before.relocations, 20U);
}

TEST(DynamicOctree, RefusesAndStaysAsItWas) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(DynamicOctree<float>({0}), std::invalid_argument);
  Model<float> model;
  model.insert(1, cube(0));
  EXPECT_THROW(model.octree.insert(1, cube(3)), std::invalid_argument);
  EXPECT_THROW(model.octree.insert(2, cube(nan)), std::invalid_argument);
  EXPECT_THROW(model.octree.insert(2, cube(0, -1)), std::invalid_argument);
  EXPECT_THROW(model.octree.update(1, cube(nan)), std::invalid_argument);
  EXPECT_THROW(model.octree.update(2, cube(0)), std::invalid_argument);
  EXPECT_THROW(model.octree.erase(2), std::invalid_argument);
  model.insert(2, cube(0.5F));
  model.step();
  EXPECT_GT(model.octree.bytes(), 0U);
}

TEST(DynamicOctree, SaysNothingOfWhatComesAndGoesBetweenSteps) {
  Model<float> model;
  model.insert(1, cube(0));
  model.step();
  model.insert(2, cube(0));
  model.erase(2);
  model.update(1, cube(9));
  model.update(1, cube(0));
  model.step();
  model.insert(2, cube(0));
  model.step();
  model.erase(2);
  model.insert(2, cube(0.5F));
  model.step();
}

}  // namespace
}  // namespace sweepgrid::baselines::dynamic_octree_test
