// What the parameters of generated scenes promise, beyond those of the paper's scene.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "scenes/open_scene.hpp"
#include "scenes/scene_error.hpp"
#include "scenes_data/fingerprint.hpp"
#include "scenes_data/scene_files.hpp"

namespace sweepgrid::accuracy_scenes_test {
namespace {

using scene_files::failure;
using scene_files::fingerprint;
using scene_files::Objects;
using scene_files::play;

const std::string kSmall = "n=300,steps=12";

// Red is legitimate when a generator was changed on purpose: measurements of before and after cannot be compared then.
TEST(RegimeScenes, AreTheSameOnEveryMachine) {
  EXPECT_EQ(fingerprint("fast:" + kSmall), 12427974013160632634U);
  EXPECT_EQ(fingerprint("far:" + kSmall), 15876860871746441230U);
  EXPECT_EQ(fingerprint("resting:" + kSmall), 13109660981222778231U);
  EXPECT_EQ(fingerprint("turning:" + kSmall), 13324716092486997424U);
  EXPECT_EQ(fingerprint("turning:dim=2," + kSmall), 7479807743008970624U);
  EXPECT_EQ(fingerprint("wall:" + kSmall), 10430584982864173713U);
  EXPECT_EQ(fingerprint("lattice:" + kSmall), 11106184214031289936U);
  EXPECT_EQ(fingerprint("plates:" + kSmall), 4024980165014495585U);
  EXPECT_EQ(fingerprint("crossing:" + kSmall), 16104371714437219661U);
  EXPECT_EQ(fingerprint("point:" + kSmall), 14255089297376712681U);
  EXPECT_EQ(fingerprint("huge:" + kSmall), 5248645585084684756U);
}

double distance(const SceneBox& a, const SceneBox& b) {
  double squared = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) squared += std::pow(a.min[axis] - b.min[axis], 2);
  return std::sqrt(squared);
}

TEST(RegimeScenes, FastObjectsMoveByTheAskedWidths) {
  const std::vector<Objects> frames = play("fast:n=200,steps=5,speed=100,density=1e-9,width=0.5");
  std::size_t whole = 0;
  for (const auto& [key, box] : frames[0]) whole += std::abs(distance(box, frames[1].at(key)) - 50) < 1e-6 ? 1 : 0;
  EXPECT_GT(whole, 150U);  // the others have bounced
}

TEST(RegimeScenes, FarScenesAreTheSameSceneElsewhere) {
  // Whole numbers, so that nothing is rounded.
  const std::string rest = "n=100,steps=3,snap=1,speed=1,moving=1,churn=0.1";
  const std::vector<Objects> near = play("uniform:" + rest);
  const std::vector<Objects> far = play("uniform:offset=1e8," + rest);
  ASSERT_EQ(near.size(), far.size());
  for (std::size_t i = 0; i < near.size(); ++i) {
    for (const auto& [key, box] : near[i]) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(far[i].at(key).min[axis], box.min[axis] + 1e8);
        EXPECT_EQ(far[i].at(key).max[axis], box.max[axis] + 1e8);
      }
    }
  }
  EXPECT_EQ(open_scene("far:offset=1e3,width=2")->info().bounds->min, (SceneBox::Point{2000, 2000, 2000}));
}

TEST(RegimeScenes, RestingObjectsShakeWithinTheirJitterAndNeverDrift) {
  const std::vector<Objects> frames = play("resting:n=1000,steps=30,width=2");
  std::size_t still = 0;
  std::size_t moved = 0;
  for (const auto& [key, box] : frames[0]) {
    double furthest = 0;
    for (const Objects& frame : frames) furthest = std::max(furthest, distance(box, frame.at(key)));
    (furthest <= 0.005 * 2 * std::sqrt(3) + 1e-9 ? still : moved) += 1;
  }
  EXPECT_EQ(moved, 10U);
  EXPECT_EQ(still, 990U);
  EXPECT_NE(frames[1], frames[2]);
}

TEST(RegimeScenes, OrientedBoxesAreWithinTheirBoxesAndKeepTheirForm) {
  for (const std::string dim : {"2", "3"}) {
    const auto source = open_scene("turning:n=200,steps=20,width=3,churn=0.02,dim=" + dim);
    EXPECT_EQ(source->info().shapes, ShapeKind::kOrientedBoxes);
    std::map<SceneKey, OrientedBox> first;
    std::size_t turned = 0;
    for (SceneStep step; source->next(step);) {
      ASSERT_EQ(step.inserted_shapes.size(), step.inserted.size());
      ASSERT_EQ(step.updated_shapes.size(), step.updated.size());
      const auto check = [&](const OrientedBox& shape, const SceneBox& box) {
        const std::size_t axes = dim == "2" ? 2 : 3;
        double squared = 0;
        for (std::size_t axis = 0; axis < axes; ++axis) {
          double reach = 0;
          for (std::size_t edge = 0; edge < axes; ++edge) {
            reach += std::abs(shape.half_edges[edge][axis]);
            squared += std::pow(shape.half_edges[edge][axis], 2);
          }
          EXPECT_LE(box.min[axis], shape.centre[axis] - reach);
          EXPECT_GE(box.max[axis], shape.centre[axis] + reach);
          EXPECT_NEAR(box.max[axis] - box.min[axis], 2 * reach, 1e-9);
        }
        EXPECT_NEAR(squared, 1.5 * 1.5, 1e-9);
        EXPECT_TRUE(axes == 3 || (box.min[2] == 0 && box.max[2] == 0));
        for (std::size_t a = 0; a < 3; ++a) {
          for (std::size_t b = a + 1; b < 3; ++b) {
            double dot = 0;
            for (std::size_t i = 0; i < 3; ++i) dot += shape.half_edges[a][i] * shape.half_edges[b][i];
            EXPECT_NEAR(dot, 0, 1e-9);
          }
        }
      };
      for (std::size_t i = 0; i < step.inserted.size(); ++i) {
        check(step.inserted_shapes[i], step.inserted_boxes[i]);
        first[step.inserted[i]] = step.inserted_shapes[i];
      }
      for (std::size_t i = 0; i < step.updated.size(); ++i) {
        check(step.updated_shapes[i], step.updated_boxes[i]);
        turned += step.updated_shapes[i].half_edges != first.at(step.updated[i]).half_edges ? 1 : 0;
      }
    }
    EXPECT_GT(turned, 3000U);
  }
}

TEST(RegimeScenes, WallsLieOnTheAskedAxis) {
  for (const Objects& objects : play("wall:" + kSmall)) {
    for (const auto& [key, box] : objects) EXPECT_TRUE(box.min[0] == 0 && box.max[0] == 1);
  }
  const SceneBox world = *open_scene("pile:axis=1,layers=3,n=5000")->info().bounds;
  EXPECT_EQ(world.max[1], 3);
  EXPECT_GT(world.max[0], 10);
  EXPECT_EQ(world.max[0], world.max[2]);
  EXPECT_EQ(open_scene("pile:dim=2,layers=3,n=5000")->info().bounds->max[1], 3);
}

TEST(RegimeScenes, LatticesHoldMultiplesOnly) {
  for (const double snap : {1.0, 0.25}) {
    std::set<double> places;
    for (const Objects& objects : play("lattice:width=2,snap=" + std::to_string(snap) + "," + kSmall)) {
      for (const auto& [key, box] : objects) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          EXPECT_EQ(std::fmod(box.min[axis], 2 * snap), 0);
          places.insert(box.min[axis]);
        }
      }
    }
    EXPECT_LT(places.size(), 100U);
    EXPECT_GT(places.size(), 3U);
  }
}

TEST(RegimeScenes, PlatesHaveTheAskedThickness) {
  for (const double thin : {0.0, 0.1}) {
    for (const Objects& objects : play("plates:axis=1,thin=" + std::to_string(thin) + "," + kSmall)) {
      for (const auto& [key, box] : objects) {
        EXPECT_NEAR(box.max[1] - box.min[1], thin, 1e-12);
        EXPECT_NEAR(box.max[0] - box.min[0], 1, 1e-12);
      }
    }
  }
}

TEST(RegimeScenes, CoversHoldEveryObject) {
  const auto source = open_scene("uniform:covers=3,moving=1,churn=0.1,offset=5," + kSmall);
  const SceneBox world = *source->info().bounds;
  std::size_t covers = 0;
  const std::vector<Objects> frames = play(*source);
  for (const Objects& objects : frames) {
    EXPECT_EQ(objects.size(), 300U);
    for (const auto& [key, box] : objects) covers += box == world ? 1 : 0;
  }
  EXPECT_EQ(covers, 3 * frames.size());
}

// A border of any spacing is crossed by the low corner in each step, on every axis.
TEST(RegimeScenes, CrossersGoToAndFroOverMultiplesOfTheSpacing) {
  const std::vector<Objects> frames = play("crossing:cross=4,speed=0.5,width=2,moving=0.5," + kSmall);
  // The first step brings them from where they appeared to their border.
  for (std::size_t i = 3; i < frames.size(); ++i) {
    std::size_t crossed = 0;
    for (const auto& [key, box] : frames[i]) {
      const SceneBox& before = frames[i - 1].at(key);
      if (box == before) continue;
      ++crossed;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(std::abs(box.min[axis] - before.min[axis]), 1, 1e-12);
        EXPECT_EQ(std::abs(std::floor(box.min[axis] / 8) - std::floor(before.min[axis] / 8)), 1);
      }
      EXPECT_EQ(box, frames[i - 2].at(key));
    }
    EXPECT_EQ(crossed, 150U);
  }
}

TEST(RegimeScenes, APointIsOnePoint) {
  const Objects start = play("point:" + kSmall).front();
  EXPECT_EQ(start.size(), 300U);
  for (const auto& [key, box] : start) EXPECT_EQ(box, start.at(0));
}

TEST(RegimeScenes, HugeScenesReachTheLimitsOfFloatAndToInfinity) {
  std::size_t up = 0;
  std::size_t down = 0;
  const Objects start = play("huge:n=1000,steps=0,axis=1").front();
  for (const auto& [key, box] : start) {
    EXPECT_TRUE(box.valid());
    for (const std::size_t axis : {0, 2}) {
      EXPECT_LT(box.max[axis], std::numeric_limits<float>::max());
      EXPECT_NEAR(box.max[axis] - box.min[axis], 1e36, 1e26);
    }
    up += std::isinf(box.max[1]) ? 1 : 0;
    down += std::isinf(box.min[1]) ? 1 : 0;
  }
  EXPECT_EQ(up + down, 10U);
  EXPECT_GT(up * down, 0U);
}

TEST(RegimeScenes, BadBoxesAreInUpdatesOnlyAndAsManyAsAsked) {
  const auto source = open_scene("bad:n=1000,steps=20,churn=0.01,nan=0.02,inverted=0.03,thin=0.5");
  SceneStep step;
  ASSERT_TRUE(source->next(step));
  std::size_t nans = 0;
  std::size_t inverted = 0;
  std::size_t updates = 0;
  do {
    for (const SceneBox& box : step.inserted_boxes) EXPECT_TRUE(box.valid());
    for (const SceneBox& box : step.updated_boxes) {
      ++updates;
      if (box.valid()) continue;
      bool has_nan = false;
      for (std::size_t axis = 0; axis < 3; ++axis) has_nan |= std::isnan(box.min[axis]) || std::isnan(box.max[axis]);
      (has_nan ? nans : inverted) += 1;
    }
  } while (source->next(step));
  EXPECT_NEAR(static_cast<double>(nans), 0.02 * static_cast<double>(updates), 100);
  EXPECT_NEAR(static_cast<double>(inverted), 0.03 * static_cast<double>(updates), 100);
  EXPECT_GT(nans * inverted, 0U);
}

TEST(RegimeScenes, ThinObjectsCanBeInvertedToo) {
  const auto source = open_scene("bad:n=100,steps=3,nan=0,inverted=1,thin=0");
  SceneStep step;
  source->next(step);
  while (source->next(step)) {
    for (const SceneBox& box : step.updated_boxes) EXPECT_FALSE(box.valid());
  }
}

TEST(RegimeScenes, OrientedBoxesRefuseWhatTheyCannotBe) {
  for (const std::string key : {"snap=1", "thin=0", "covers=1", "infinite=0.1"}) {
    EXPECT_NE(failure("turning:" + key).find("oriented boxes (turn) go with neither"), std::string::npos) << key;
  }
}

}  // namespace
}  // namespace sweepgrid::accuracy_scenes_test
