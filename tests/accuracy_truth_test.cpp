// The three truths, against cases worked out by hand and against brute force in rational numbers.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <boost/multiprecision/cpp_int.hpp>

#include "accuracy/exact_tests.hpp"
#include "accuracy/truth.hpp"
#include "scenes/open_scene.hpp"
#include "scenes/random_stream.hpp"

#include "sanitized.hpp"

namespace sweepgrid::accuracy::accuracy_truth_test {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using Pairs = std::vector<ScenePair>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

SceneBox square(double x, double y, double edge = 1) { return SceneBox({x, y, 0}, {x + edge, y + edge, 0}); }

SceneInfo scene_of(ShapeKind shapes, int dim = 3) {
  SceneInfo info;
  info.shapes = shapes;
  info.dim = dim;
  return info;
}

SceneStep start(const std::vector<SceneBox>& boxes) {
  SceneStep step;
  for (const SceneBox& box : boxes) {
    step.inserted.push_back(step.inserted.size());
    step.inserted_boxes.push_back(box);
  }
  return step;
}

SceneStep moved(SceneKey key, const SceneBox& box) {
  SceneStep step;
  step.updated = {key};
  step.updated_boxes = {box};
  return step;
}

TEST(InstantTruth, TouchingBoxesOverlapAndTheNextNumberOnDoesNot) {
  const auto truth = make_truth(TruthKind::kInstants, scene_of(ShapeKind::kBoxes));
  const double beyond = std::nextafter(1.0, 2.0);
  const auto box = [](double x, double y, double z) { return SceneBox({x, y, z}, {x + 1, y + 1, z + 1}); };
  EXPECT_EQ(truth->step(start({box(0, 0, 0), box(1, 1, 1), box(0, 0, beyond), box(0.5, -1, 0)})), (Pairs{
                                                                                                      {0, 1},
                                                                                                      {0, 3},
                                                                                                      {1, 2},
                                                                                                  }));
}

TEST(InstantTruth, FollowsUpdatesInsertsAndErases) {
  const auto truth = make_truth(TruthKind::kInstants, scene_of(ShapeKind::kBoxes));
  EXPECT_EQ(truth->step(start({square(0, 0), square(5, 0), square(0.5, 0)})), (Pairs{{0, 2}}));
  EXPECT_EQ(truth->step(moved(1, square(1, 0))), (Pairs{{0, 1}, {0, 2}, {1, 2}}));
  SceneStep step;
  step.erased = {0};
  step.inserted = {7};
  step.inserted_boxes = {square(2, 1)};
  EXPECT_EQ(truth->step(step), (Pairs{{1, 2}, {1, 7}}));
}

TEST(InstantTruth, InfiniteBoxesOverlapWhatTheyReach) {
  const auto truth = make_truth(TruthKind::kInstants, scene_of(ShapeKind::kBoxes));
  const SceneBox right({3, 0, 0}, {kInfinity, 1, 1});
  const SceneBox all({-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity});
  EXPECT_EQ(truth->step(start({square(0, 0), square(1e300, 0), right, all})), (Pairs{{0, 3}, {1, 2}, {1, 3}, {2, 3}}));
}

TEST(MotionTruth, SeesWhatPassesBetweenTwoInstants) {
  const auto truth = make_truth(TruthKind::kMotion, scene_of(ShapeKind::kBoxes));
  EXPECT_EQ(truth->step(start({square(0, 0), square(-30, 0.5)})), Pairs{});
  EXPECT_EQ(truth->step(moved(1, square(40, 0.5))), (Pairs{{0, 1}}));
  EXPECT_EQ(truth->step(SceneStep()), Pairs{});
}

TEST(MotionTruth, CountsBothEndsOfTheStep) {
  const auto truth = make_truth(TruthKind::kMotion, scene_of(ShapeKind::kBoxes));
  EXPECT_EQ(truth->step(start({square(0, 0), square(1, 0)})), (Pairs{{0, 1}}));
  EXPECT_EQ(truth->step(moved(1, square(9, 0))), (Pairs{{0, 1}}));  // still there when the step began
  EXPECT_EQ(truth->step(moved(1, square(1, 0))), (Pairs{{0, 1}}));
}

// The corner passes the corner of the other at one instant, half way: x = 2 - 2t and y = 2t are both 1 at most then.
TEST(MotionTruth, CornersThatTouchForOneInstantMeetAndPassByOtherwise) {
  const MovingBox rests{square(0, 0), square(0, 0)};
  EXPECT_TRUE(meet_in_motion(rests, {square(2, 0), square(0, 2)}));
  const double beyond = std::nextafter(2.0, 3.0);
  const SceneBox late({beyond, 0, 0}, {beyond + 1, 1, 0});
  EXPECT_FALSE(meet_in_motion(rests, {late, square(0, 2)}));
  const double before = std::nextafter(2.0, 1.0);
  const SceneBox early({before, 0, 0}, {before + 1, 1, 0});
  EXPECT_TRUE(meet_in_motion(rests, {early, square(0, 2)}));
  // The same far from the origin, where a double has no digits left for the difference.
  const double far = 0x1p52;
  EXPECT_TRUE(meet_in_motion({square(far, far), square(far, far)}, {square(far + 2, far), square(far, far + 2)}));
  EXPECT_FALSE(meet_in_motion({square(far, far), square(far, far)}, {square(far + 3, far), square(far, far + 2)}));
}

TEST(MotionTruth, ObjectsAreNotThereBeforeTheyAreInsertedNorAfterTheyAreErased) {
  const auto truth = make_truth(TruthKind::kMotion, scene_of(ShapeKind::kBoxes));
  truth->step(start({square(-30, 0), square(50, 0)}));
  SceneStep step = moved(0, square(40, 0));  // over the place where another appears
  step.inserted = {2};
  step.inserted_boxes = {square(0, 0)};
  EXPECT_EQ(truth->step(step), Pairs{});
  step = moved(0, square(-30, 0));
  step.erased = {2};
  EXPECT_EQ(truth->step(step), Pairs{});
}

TEST(MotionTruth, EndpointsThatBecomeInfiniteAreSoAtOnce) {
  const MovingBox rests{square(5, 0), square(5, 0)};
  const SceneBox reaches({0, 0, 0}, {kInfinity, 1, 0});
  EXPECT_TRUE(meet_in_motion(rests, {square(0, 0), reaches}));
  EXPECT_FALSE(meet_in_motion(rests, {square(0, 3), SceneBox({0, 3, 0}, {kInfinity, 4, 0})}));
  // On x they meet after the first instant only, on y at the first instant only: never on both.
  EXPECT_FALSE(meet_in_motion(rests, {square(0, 1), SceneBox({0, 2, 0}, {kInfinity, 3, 0})}));
}

/// Every time at which any condition may change, and one between each two, in rational numbers.
bool meet_by_brute_force(const MovingBox& a, const MovingBox& b) {
  std::vector<Rational> times = {0, 1};
  const auto at = [](double before, double after, const Rational& t) {
    return Rational(before) + t * (Rational(after) - Rational(before));
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const auto& [low, high] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
      const Rational gap = Rational(high->before.max[axis]) - Rational(low->before.min[axis]);
      const Rational last = Rational(high->after.max[axis]) - Rational(low->after.min[axis]);
      if (gap == last) continue;
      const Rational root = gap / (gap - last);
      if (root > 0 && root < 1) times.push_back(root);
    }
  }
  std::sort(times.begin(), times.end());
  for (std::size_t i = times.size() - 1; i > 0; --i) times.push_back((times[i] + times[i - 1]) / 2);
  return std::any_of(times.begin(), times.end(), [&](const Rational& t) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (at(a.before.min[axis], a.after.min[axis], t) > at(b.before.max[axis], b.after.max[axis], t)) return false;
      if (at(b.before.min[axis], b.after.min[axis], t) > at(a.before.max[axis], a.after.max[axis], t)) return false;
    }
    return true;
  });
}

TEST(MotionTruth, IsThatOfRationalNumbers) {
  RandomStream random(3);
  std::size_t met = 0;
  std::size_t passed = 0;
  constexpr int kRounds = oracle::kSanitized ? 3000 : 20000;
  for (int round = 0; round < kRounds; ++round) {
    // Few whole numbers give ties without end; tenths are no doubles.
    const double unit = round % 2 == 0 ? 1 : 0.1;
    const double origin = round % 3 == 0 ? 1e9 : 0;
    const auto random_box = [&] {
      SceneBox box;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        box.min[axis] = origin + unit * static_cast<double>(random.below(8));
        box.max[axis] = box.min[axis] + unit * static_cast<double>(random.below(3));
      }
      return box;
    };
    const MovingBox a{random_box(), random_box()};
    const MovingBox b{random_box(), random_box()};
    const bool expected = meet_by_brute_force(a, b);
    ASSERT_EQ(meet_in_motion(a, b), expected) << "round " << round;
    ASSERT_EQ(meet_in_motion(b, a), expected) << "round " << round;
    if (expected) ++met;
    if (expected && !a.before.overlaps(b.before) && !a.after.overlaps(b.after)) ++passed;
  }
  EXPECT_GT(met, kRounds / 40U);
  EXPECT_GT(passed, kRounds / 200U);
}

TEST(ShapeTruth, SpheresTouchToTheLastDigit) {
  const auto sphere = [](double x, double y, double z, double radius, double far = 0) {
    return SceneBox({far + x - radius, far + y - radius, far + z - radius},
                    {far + x + radius, far + y + radius, far + z + radius});
  };
  // 2² + 3² + 6² = 7².
  EXPECT_TRUE(spheres_touch(sphere(0, 0, 0, 3), sphere(2, 3, 6, 4), 3));
  EXPECT_TRUE(spheres_touch(sphere(0, 0, 0, 3, 1e9), sphere(2, 3, 6, 4, 1e9), 3));
  EXPECT_FALSE(spheres_touch(sphere(0, 0, 0, 3), sphere(2, 3, 6 + 0x1p-49, 4), 3));
  EXPECT_FALSE(spheres_touch(sphere(0, 0, 0, 3, 1e9), sphere(2, 3, 6 + 0x1p-20, 4, 1e9), 3));
  // 3² + 4² = 5² in the plane, where z counts for nothing.
  const SceneBox a({-2, -2, 0}, {2, 2, 0});
  const SceneBox b({0, 1, 0}, {6, 7, 0});
  EXPECT_TRUE(spheres_touch(a, b, 2));
  EXPECT_FALSE(spheres_touch(a, SceneBox({std::nextafter(0.0, 1.0), 1, 0}, {6, 7, 0}), 2));
}

TEST(ShapeTruth, ASphereFillsTheLeastEdgeOfItsBox) {
  const auto truth = make_truth(TruthKind::kShapes, scene_of(ShapeKind::kSpheres));
  const SceneBox unit({0, 0, 0}, {2, 2, 2});
  // Boxes overlap, the sphere of diameter 2 around (4, 1, 1) touches none but at (2, 1, 1) + 1.
  EXPECT_EQ(truth->step(start({unit, SceneBox({1.5, 0, 0}, {6.5, 2, 2}), SceneBox({2, 0, 0}, {4, 2, 2})})),
            (Pairs{{0, 2}, {1, 2}}));
}

OrientedBox cube(double x, double y, double z, double half = 1) {
  return {{x, y, z}, {{{half, 0, 0}, {0, half, 0}, {0, 0, half}}}};
}

// A box turned by 45 degrees about z: its corner reaches 1 in x and in y.
OrientedBox diamond(double x, double y, double z) { return {{x, y, z}, {{{0.5, 0.5, 0}, {-0.5, 0.5, 0}, {0, 0, 1}}}}; }

TEST(ShapeTruth, OrientedBoxesTouchWithFacesCornersAndEdges) {
  EXPECT_TRUE(oriented_boxes_touch(cube(0, 0, 0), cube(2, 2, 2)));
  EXPECT_FALSE(oriented_boxes_touch(cube(0, 0, 0), cube(2, 2, 2 + 0x1p-51)));
  EXPECT_TRUE(oriented_boxes_touch(cube(0, 0, 0), diamond(2, 0, 0)));  // corner in a face
  EXPECT_FALSE(oriented_boxes_touch(cube(0, 0, 0), diamond(2 + 0x1p-51, 0, 0)));
  EXPECT_FALSE(oriented_boxes_touch(cube(0, 0, 0), diamond(1.875, 1.875, 0)));  // the boxes around them overlap
  EXPECT_TRUE(oriented_boxes_touch(cube(0, 0, 0), diamond(1.5, 1.5, 0)));       // face in an edge
  EXPECT_FALSE(oriented_boxes_touch(cube(0, 0, 0), diamond(1.5, 1.5 + 0x1p-51, 0)));
  // Two diamonds whose edges cross: one about z, one about y; on no face normal are they apart.
  const OrientedBox upright = {{0, 0, 0}, {{{0.5, 0.5, 0}, {-0.5, 0.5, 0}, {0, 0, 4}}}};
  const auto lying = [](double x) { return OrientedBox{{x, 0, 0}, {{{0.5, 0, 0.5}, {-0.5, 0, 0.5}, {0, 4, 0}}}}; };
  EXPECT_TRUE(oriented_boxes_touch(upright, lying(2)));
  EXPECT_FALSE(oriented_boxes_touch(upright, lying(2 + 0x1p-51)));
}

using Exact = std::array<Rational, 3>;

std::array<Exact, 8> corners(const OrientedBox& box) {
  std::array<Exact, 8> result;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      result[corner][axis] = Rational(box.centre[axis]);
      for (std::size_t edge = 0; edge < 3; ++edge) {
        const Rational part(box.half_edges[edge][axis]);
        result[corner][axis] += (corner >> edge & 1) != 0 ? part : Rational(-part);
      }
    }
  }
  return result;
}

Exact cross(const std::array<double, 3>& u, const std::array<double, 3>& v) {
  Exact result;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    result[i] = Rational(u[j]) * Rational(v[k]) - Rational(u[k]) * Rational(v[j]);
  }
  return result;
}

/// Shadows of all corners on all axes, in rational numbers.
bool touch_by_brute_force(const OrientedBox& a, const OrientedBox& b) {
  std::vector<std::array<double, 3>> edges(a.half_edges.begin(), a.half_edges.end());
  edges.insert(edges.end(), b.half_edges.begin(), b.half_edges.end());
  for (const auto& u : edges) {
    for (const auto& v : edges) {
      const Exact axis = cross(u, v);
      const auto shadow = [&axis](const OrientedBox& box) {
        std::vector<Rational> places;
        for (const Exact& corner : corners(box)) {
          places.push_back(Rational(axis[0] * corner[0] + axis[1] * corner[1] + axis[2] * corner[2]));
        }
        const auto [low, high] = std::minmax_element(places.begin(), places.end());
        return std::pair<Rational, Rational>(*low, *high);
      };
      const auto [a_low, a_high] = shadow(a);
      const auto [b_low, b_high] = shadow(b);
      if (a_low > b_high || b_low > a_high) return false;
    }
  }
  return true;
}

TEST(ShapeTruth, OrientedBoxesAreThoseOfRationalNumbers) {
  RandomStream random(5);
  std::size_t touched = 0;
  constexpr int kRounds = oracle::kSanitized ? 200 : 1000;
  for (int round = 0; round < kRounds; ++round) {
    // Small whole numbers: edges are parallel, and corners touch, again and again.
    const auto random_box = [&] {
      while (true) {
        OrientedBox box;
        for (double& x : box.centre)
          x = random.between(0, 1) < 0.5 ? std::floor(random.between(0, 5)) : random.between(0, 5);
        for (auto& edge : box.half_edges) {
          for (double& x : edge) x = round % 2 == 0 ? std::floor(random.between(-1, 2)) : random.between(-1, 1);
        }
        const Exact normal = cross(box.half_edges[0], box.half_edges[1]);
        Rational volume = 0;
        for (std::size_t i = 0; i < 3; ++i) volume += normal[i] * Rational(box.half_edges[2][i]);
        if (volume != 0) return box;
      }
    };
    const OrientedBox a = random_box();
    const OrientedBox b = random_box();
    const bool expected = touch_by_brute_force(a, b);
    ASSERT_EQ(oriented_boxes_touch(a, b), expected) << "round " << round;
    ASSERT_EQ(oriented_boxes_touch(b, a), expected) << "round " << round;
    if (expected) ++touched;
  }
  EXPECT_GT(touched, kRounds / 10U);
  EXPECT_LT(touched, kRounds * 9U / 10U);
}

struct Truths {
  Pairs instants, motion, shapes;
};

/// All three, step by step.
std::vector<Truths> truths_of(const std::string& scene, std::size_t steps) {
  const auto source = open_scene(scene);
  const auto instants = make_truth(TruthKind::kInstants, source->info());
  const auto motion = make_truth(TruthKind::kMotion, source->info());
  const auto shapes = make_truth(TruthKind::kShapes, source->info());
  std::vector<Truths> result;
  for (SceneStep step; result.size() <= steps && source->next(step);) {
    result.push_back({instants->step(step), motion->step(step), shapes->step(step)});
  }
  return result;
}

bool holds_all(const Pairs& all, const Pairs& some) {
  return std::includes(all.begin(), all.end(), some.begin(), some.end(), ScenePairOrder());
}

TEST(Truths, StandAsTheyMustToEachOther) {
  const std::string recordings = SWEEPGRID_RECORDINGS;
  for (const std::string& scene :
       {std::string("fast:n=300,steps=10,density=0.3"), std::string("turning:n=500,steps=10"),
        std::string("turning:n=500,steps=10,dim=2"), std::string("lattice:n=500,steps=10,churn=0.05"),
        std::string("far:n=500,steps=5,offset=1e12,density=0.5"), recordings + "/lammps_pour_2200.lammpstrj.xz"}) {
    SCOPED_TRACE(scene);
    const std::vector<Truths> truths = truths_of(scene, 10);
    std::size_t passed = 0;
    std::size_t apart = 0;
    for (std::size_t i = 0; i < truths.size(); ++i) {
      EXPECT_TRUE(holds_all(truths[i].motion, truths[i].instants)) << "step " << i;
      EXPECT_TRUE(holds_all(truths[i].instants, truths[i].shapes)) << "step " << i;
      passed += truths[i].motion.size() - truths[i].instants.size();
      apart += truths[i].instants.size() - truths[i].shapes.size();
    }
    EXPECT_FALSE(truths.back().instants.empty());
    if (scene.starts_with("fast")) {
      EXPECT_GT(passed, 100U);
    }
    if (!scene.starts_with("turning") && scene.find("lammps") == std::string::npos) {
      EXPECT_EQ(apart, 0U);
    } else {
      EXPECT_GT(apart, 100U);
      EXPECT_FALSE(truths.back().shapes.empty());
    }
  }
}

}  // namespace
}  // namespace sweepgrid::accuracy::accuracy_truth_test
