#include "accuracy/truth.hpp"

#include <algorithm>
#include <cstddef>
#include <unordered_map>

#include "accuracy/exact_tests.hpp"
#include "accuracy/extent_sweep.hpp"

namespace sweepgrid::accuracy {
namespace {

struct Object {
  SceneKey key = 0;
  MovingBox box;
  OrientedBox shape;   // of scenes that have them
  bool is_new = true;  // not there before the step
};

SceneBox hull(const SceneBox& a, const SceneBox& b) {
  SceneBox hull = a;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    hull.min[axis] = std::min(a.min[axis], b.min[axis]);
    hull.max[axis] = std::max(a.max[axis], b.max[axis]);
  }
  return hull;
}

/// Follows the objects of a scene and sweeps over extents of theirs; what makes a pair true is the kinds' to say.
class SweepTruth : public Truth {
 public:
  const std::vector<ScenePair>& step(const SceneStep& step) final {
    apply(step);
    extents_.clear();
    for (std::size_t i = 0; i < objects_.size(); ++i) extents_.push_back({extent(objects_[i]), i});
    pairs_.clear();
    for_each_meeting(extents_, [this](std::size_t i, std::size_t j) {
      const Object& a = objects_[i];
      const Object& b = objects_[j];
      if (holds(a, b)) pairs_.push_back({std::min(a.key, b.key), std::max(a.key, b.key)});
    });
    std::sort(pairs_.begin(), pairs_.end(), ScenePairOrder());
    return pairs_;
  }

 protected:
  /// What a pair must overlap in to be asked for.
  [[nodiscard]] virtual SceneBox extent(const Object& object) const { return object.box.after; }
  [[nodiscard]] virtual bool holds(const Object& a, const Object& b) const = 0;

 private:
  void apply(const SceneStep& step) {
    for (Object& object : objects_) {
      object.box.before = object.box.after;
      object.is_new = false;
    }
    for (const SceneKey key : step.erased) erase(key);
    for (std::size_t i = 0; i < step.inserted.size(); ++i) {
      places_[step.inserted[i]] = objects_.size();
      Object& object = objects_.emplace_back();
      object.key = step.inserted[i];
      object.box = {step.inserted_boxes[i], step.inserted_boxes[i]};
      if (!step.inserted_shapes.empty()) object.shape = step.inserted_shapes[i];
    }
    for (std::size_t i = 0; i < step.updated.size(); ++i) {
      Object& object = objects_[places_.at(step.updated[i])];
      object.box.after = step.updated_boxes[i];
      if (!step.updated_shapes.empty()) object.shape = step.updated_shapes[i];
    }
  }

  void erase(SceneKey key) {
    const auto found = places_.find(key);
    const std::size_t place = found->second;
    places_.erase(found);
    if (place + 1 != objects_.size()) {
      objects_[place] = objects_.back();
      places_[objects_[place].key] = place;
    }
    objects_.pop_back();
  }

  std::vector<Object> objects_;
  std::unordered_map<SceneKey, std::size_t> places_;  // in objects_
  std::vector<Extent> extents_;
  std::vector<ScenePair> pairs_;
};

class InstantTruth final : public SweepTruth {
 protected:
  [[nodiscard]] bool holds(const Object&, const Object&) const override { return true; }
};

class MotionTruth final : public SweepTruth {
 protected:
  [[nodiscard]] SceneBox extent(const Object& object) const override {
    return hull(object.box.before, object.box.after);
  }
  [[nodiscard]] bool holds(const Object& a, const Object& b) const override {
    if (a.is_new || b.is_new) return a.box.after.overlaps(b.box.after);
    return meet_in_motion(a.box, b.box);
  }
};

class SphereTruth final : public SweepTruth {
 public:
  explicit SphereTruth(int dim) : dim_(dim) {}

 protected:
  [[nodiscard]] bool holds(const Object& a, const Object& b) const override {
    return spheres_touch(a.box.after, b.box.after, dim_);
  }

 private:
  int dim_;
};

class OrientedTruth final : public SweepTruth {
 protected:
  [[nodiscard]] bool holds(const Object& a, const Object& b) const override {
    return oriented_boxes_touch(a.shape, b.shape);
  }
};

}  // namespace

std::unique_ptr<Truth> make_truth(TruthKind kind, const SceneInfo& scene) {
  if (kind == TruthKind::kMotion) return std::make_unique<MotionTruth>();
  if (kind == TruthKind::kShapes && scene.shapes == ShapeKind::kSpheres)
    return std::make_unique<SphereTruth>(scene.dim);
  if (kind == TruthKind::kShapes && scene.shapes == ShapeKind::kOrientedBoxes) return std::make_unique<OrientedTruth>();
  return std::make_unique<InstantTruth>();
}

}  // namespace sweepgrid::accuracy
