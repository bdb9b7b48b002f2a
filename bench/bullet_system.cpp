#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCallback.h>

#include "system.hpp"

extern btScalar gDbvtMargin;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables): Bullet's

namespace sweepgrid::bench {
namespace {

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

class BulletSystem final : public System {
 public:
  explicit BulletSystem(std::uint32_t objects) : proxies_(objects) {
    gDbvtMargin = 0;                      // exact boxes
    broadphase_.m_deferedcollide = true;  // all collisions in calculateOverlappingPairs, once per step
    broadphase_.m_cupdates = 100;         // every pair is checked for its end in every step
    broadphase_.getOverlappingPairCache()->setInternalGhostPairCallback(&events_);
  }

  void queue(const ScriptStep& step) override {
    for (const std::uint32_t object : step.erased) broadphase_.destroyProxy(proxies_[object], nullptr);
    for (std::size_t i = 0; i < step.inserted.size(); ++i) {
      const FloatBox& box = step.inserted_boxes[i];
      btBroadphaseProxy*& proxy = proxies_[step.inserted[i]];
      proxy = broadphase_.createProxy(vector(box.min), vector(box.max), BOX_SHAPE_PROXYTYPE, &proxy, 1, 1, nullptr);
    }
    for (std::size_t i = 0; i < step.updated.size(); ++i) {
      const FloatBox& box = step.updated_boxes[i];
      // Not setAabb(): it keeps the old box when that contains the new one, so that a box that shrinks is not exact.
      broadphase_.setAabbForceUpdate(proxies_[step.updated[i]], vector(box.min), vector(box.max), nullptr);
    }
  }

  void step() override { broadphase_.calculateOverlappingPairs(nullptr); }

  [[nodiscard]] std::vector<ObjectPair> pairs() const override {
    const auto& array = const_cast<btDbvtBroadphase&>(broadphase_).getOverlappingPairCache()->getOverlappingPairArray();
    std::vector<ObjectPair> pairs;
    pairs.reserve(static_cast<std::size_t>(array.size()));
    for (int i = 0; i < array.size(); ++i) pairs.push_back({number(array[i].m_pProxy0), number(array[i].m_pProxy1)});
    return pairs;
  }
  [[nodiscard]] std::optional<EventTotals> events() const override { return events_.totals; }

 private:
  // What Bullet keeps for its client is the object's place in proxies_.
  [[nodiscard]] std::uint32_t number(const btBroadphaseProxy* proxy) const {
    return static_cast<std::uint32_t>(static_cast<btBroadphaseProxy* const*>(proxy->m_clientObject) - proxies_.data());
  }

  EventCounter events_;
  btDbvtBroadphase broadphase_;
  std::vector<btBroadphaseProxy*> proxies_;  // by object number
};

}  // namespace

std::unique_ptr<System> make_bullet(std::uint32_t objects) { return std::make_unique<BulletSystem>(objects); }

}  // namespace sweepgrid::bench
