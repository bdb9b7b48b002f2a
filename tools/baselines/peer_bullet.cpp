#include "baselines/peer_bullet.hpp"

#include <BulletCollision/BroadphaseCollision/btAxisSweep3.h>
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCallback.h>
#include <LinearMath/btAlignedAllocator.h>

#include <new>
#include <stdexcept>
#include <string>
#include <utility>

extern btScalar gDbvtMargin;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables): Bullet's

namespace sweepgrid::baselines {
namespace {

/// Bullet's own allocation goes on with null when there is no memory. Its memory of before must be freed as it was
/// allocated, so this is set for good, and before the first system is made.
struct ThrowingAllocation {
  ThrowingAllocation() {
    [[maybe_unused]] static const bool set = [] {
      btAlignedAllocSetCustom([](std::size_t size) { return ::operator new(size); },
                              [](void* memory) { ::operator delete(memory); });
      return true;
    }();
  }
};

class EventCounter final : public btOverlappingPairCallback {
 public:
  btBroadphasePair* addOverlappingPair(btBroadphaseProxy*, btBroadphaseProxy*) override {
    ++totals.begins;
    return nullptr;
  }
  void* removeOverlappingPair(btBroadphaseProxy*, btBroadphaseProxy*, btDispatcher*) override {
    ++totals.ends;
    return nullptr;
  }
  void removeOverlappingPairsContainingProxy(btBroadphaseProxy*, btDispatcher*) override {}

  EventTotals totals;
};

btVector3 vector(const FloatBox::Point& point) { return {point[0], point[1], point[2]}; }

/// Objects of a broad phase of Bullet's by number, and its pair cache.
template <class Broadphase>
class BulletSystem : public System {
 public:
  void queue(const ScriptStep& step) final {
    for (const std::uint32_t object : step.erased) broadphase_.destroyProxy(proxies_[object], nullptr);
    for (std::size_t i = 0; i < step.inserted.size(); ++i) {
      const FloatBox& box = step.inserted_boxes[i];
      btBroadphaseProxy*& proxy = proxies_[step.inserted[i]];
      proxy = broadphase_.createProxy(vector(box.min), vector(box.max), BOX_SHAPE_PROXYTYPE, &proxy, 1, 1, nullptr);
    }
    for (std::size_t i = 0; i < step.updated.size(); ++i) {
      const FloatBox& box = step.updated_boxes[i];
      move(proxies_[step.updated[i]], vector(box.min), vector(box.max));
    }
  }

  void step() final { broadphase_.calculateOverlappingPairs(nullptr); }

  [[nodiscard]] std::vector<ObjectPair> pairs() const final {
    const auto& array = const_cast<Broadphase&>(broadphase_).getOverlappingPairCache()->getOverlappingPairArray();
    std::vector<ObjectPair> pairs;
    pairs.reserve(static_cast<std::size_t>(array.size()));
    for (int i = 0; i < array.size(); ++i) pairs.push_back({number(array[i].m_pProxy0), number(array[i].m_pProxy1)});
    return pairs;
  }
  [[nodiscard]] std::optional<EventTotals> events() const final { return events_.totals; }

 protected:
  template <class... Arguments>
  explicit BulletSystem(std::uint32_t objects, Arguments&&... arguments)
      : broadphase_(std::forward<Arguments>(arguments)...), proxies_(objects) {
    broadphase_.getOverlappingPairCache()->setInternalGhostPairCallback(&events_);
  }

  virtual void move(btBroadphaseProxy* proxy, const btVector3& min, const btVector3& max) = 0;

  // Before all that allocates.
  [[no_unique_address]] ThrowingAllocation allocation_;
  EventCounter events_;
  Broadphase broadphase_;

 private:
  // What Bullet keeps for its client is the object's place in proxies_.
  [[nodiscard]] std::uint32_t number(const btBroadphaseProxy* proxy) const {
    return static_cast<std::uint32_t>(static_cast<btBroadphaseProxy* const*>(proxy->m_clientObject) - proxies_.data());
  }

  std::vector<btBroadphaseProxy*> proxies_;  // by object number
};

class DbvtSystem final : public BulletSystem<btDbvtBroadphase> {
 public:
  explicit DbvtSystem(std::uint32_t objects) : BulletSystem(objects) {
    gDbvtMargin = 0;                      // exact boxes
    broadphase_.m_deferedcollide = true;  // all collisions in calculateOverlappingPairs, once per step
    broadphase_.m_cupdates = 100;         // every pair is checked for its end in every step
  }

 protected:
  void move(btBroadphaseProxy* proxy, const btVector3& min, const btVector3& max) override {
    // Not setAabb(): it keeps the old box when that contains the new one, so that a box that shrinks is not exact.
    broadphase_.setAabbForceUpdate(proxy, min, max, nullptr);
  }
};

template <class Broadphase>
class AxisSweepSystem final : public BulletSystem<Broadphase> {
 public:
  template <class Count>
  AxisSweepSystem(const FloatBox& world, std::uint32_t objects, Count at_once)
      // Without the tree for rays that it would keep beside.
      : BulletSystem<Broadphase>(objects, vector(world.min), vector(world.max), at_once, nullptr, true) {}

 protected:
  void move(btBroadphaseProxy* proxy, const btVector3& min, const btVector3& max) override {
    this->broadphase_.setAabb(proxy, min, max, nullptr);
  }
};

}  // namespace

std::unique_ptr<System> make_bullet(std::uint32_t objects) { return std::make_unique<DbvtSystem>(objects); }

std::unique_ptr<System> make_bullet_axis_sweep(AxisSweepBits bits, const FloatBox& world, std::uint32_t objects,
                                               std::uint32_t at_once) {
  if (bits == AxisSweepBits::k32) return std::make_unique<AxisSweepSystem<bt32BitAxisSweep3>>(world, objects, at_once);
  if (at_once > kMostObjectsOfAxisSweep16) {
    throw std::length_error("btAxisSweep3 takes " + std::to_string(kMostObjectsOfAxisSweep16) + " objects at most");
  }
  return std::make_unique<AxisSweepSystem<btAxisSweep3>>(world, objects, static_cast<unsigned short>(at_once));
}

}  // namespace sweepgrid::baselines
