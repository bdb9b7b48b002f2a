#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>

#include "baselines/peer_fcl.hpp"

namespace sweepgrid::baselines {
namespace {

using Collider = fcl::CollisionObject<float>;

/// A shape that is its own bounding box. FCL adds an object's translation to the box of its shape, which would round;
/// so the boxes are where the objects are, and nothing is ever translated.
class BoxShape final : public fcl::CollisionGeometry<float> {
 public:
  explicit BoxShape(const FloatBox& box) { set(box); }

  void set(const FloatBox& box) {
    aabb_local.min_ = {box.min[0], box.min[1], box.min[2]};
    aabb_local.max_ = {box.max[0], box.max[1], box.max[2]};
  }
  void computeLocalAABB() override {}
  [[nodiscard]] fcl::OBJECT_TYPE getObjectType() const override { return fcl::OT_GEOM; }
  [[nodiscard]] fcl::NODE_TYPE getNodeType() const override { return fcl::GEOM_BOX; }
};

class FclSystem final : public System {
 public:
  FclSystem(FclUpkeep upkeep, std::uint32_t objects) : upkeep_(upkeep), shapes_(objects), colliders_(objects) {}

  void queue(const ScriptStep& step) override {
    for (const std::uint32_t object : step.erased) {
      if (upkeep_ == FclUpkeep::kUpdate) tree_.unregisterObject(colliders_[object].get());
      colliders_[object].reset();
    }
    changed_.clear();
    for (std::size_t i = 0; i < step.inserted.size(); ++i) {
      const std::uint32_t object = step.inserted[i];
      shapes_[object] = std::make_shared<BoxShape>(step.inserted_boxes[i]);
      colliders_[object] = std::make_unique<Collider>(shapes_[object]);
      colliders_[object]->setUserData(&colliders_[object]);
      changed_.push_back(colliders_[object].get());
    }
    if (upkeep_ == FclUpkeep::kUpdate) tree_.registerObjects(changed_);
    changed_.clear();
    for (std::size_t i = 0; i < step.updated.size(); ++i) move(step.updated[i], step.updated_boxes[i]);
  }

  void step() override {
    if (upkeep_ == FclUpkeep::kUpdate) {
      tree_.update(changed_);
    } else {
      rebuild();
    }
    found_.clear();
    tree_.collide(this, [](Collider* a, Collider* b, void* self) {
      auto& system = *static_cast<FclSystem*>(self);
      system.found_.push_back({system.number(a), system.number(b)});
      return false;  // go on
    });
  }

  [[nodiscard]] std::vector<ObjectPair> pairs() const override { return found_; }

 private:
  using Owner = std::unique_ptr<Collider>;

  void move(std::uint32_t object, const FloatBox& box) {
    Collider* const collider = colliders_[object].get();
    const fcl::AABB<float> old = collider->getAABB();
    shapes_[object]->set(box);
    collider->computeAABB();
    if (upkeep_ == FclUpkeep::kRebuild) return;
    // The tree's update leaves a leaf as it was when the old box contains the new one or nearly equals it.
    if (old.contain(collider->getAABB()) || old.equal(collider->getAABB())) {
      tree_.unregisterObject(collider);
      tree_.registerObject(collider);
    } else {
      changed_.push_back(collider);
    }
  }

  void rebuild() {
    changed_.clear();
    for (const Owner& collider : colliders_) {
      if (collider != nullptr) changed_.push_back(collider.get());
    }
    tree_.clear();
    tree_.registerObjects(changed_);
  }

  // What FCL keeps for its client is the object's place in colliders_.
  [[nodiscard]] std::uint32_t number(const Collider* collider) const {
    return static_cast<std::uint32_t>(static_cast<const Owner*>(collider->getUserData()) - colliders_.data());
  }

  FclUpkeep upkeep_;
  std::vector<std::shared_ptr<BoxShape>> shapes_;  // by object number
  std::vector<Owner> colliders_;                   // by object number; null: not there
  std::vector<Collider*> changed_;
  fcl::DynamicAABBTreeCollisionManager<float> tree_;
  std::vector<ObjectPair> found_;
};

}  // namespace

std::unique_ptr<System> make_fcl(FclUpkeep upkeep, std::uint32_t objects) {
  return std::make_unique<FclSystem>(upkeep, objects);
}

}  // namespace sweepgrid::baselines
