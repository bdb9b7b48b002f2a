#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCallback.h>

#include <chrono>
#include <vector>

#include "system.hpp"

extern btScalar gDbvtMargin;

namespace sweepgrid::bench {
namespace {

class EventCounter final : public btOverlappingPairCallback {
 public:
  btBroadphasePair* addOverlappingPair(btBroadphaseProxy*, btBroadphaseProxy*) override {
    ++begins;
    return nullptr;
  }
  void* removeOverlappingPair(btBroadphaseProxy*, btBroadphaseProxy*, btDispatcher*) override {
    ++ends;
    return nullptr;
  }
  void removeOverlappingPairsContainingProxy(btBroadphaseProxy*, btDispatcher*) override {}

  std::uint64_t begins = 0;
  std::uint64_t ends = 0;
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

  void step(const ScriptStep& step) override {
    for (const std::uint32_t object : step.erased) broadphase_.destroyProxy(proxies_[object], nullptr);
    for (std::size_t i = 0; i < step.inserted.size(); ++i) {
      const FloatBox& box = step.inserted_boxes[i];
      proxies_[step.inserted[i]] =
          broadphase_.createProxy(vector(box.min), vector(box.max), BOX_SHAPE_PROXYTYPE, nullptr, 1, 1, nullptr);
    }
    for (std::size_t i = 0; i < step.updated.size(); ++i) {
      const FloatBox& box = step.updated_boxes[i];
      broadphase_.setAabb(proxies_[step.updated[i]], vector(box.min), vector(box.max), nullptr);
    }
    const auto start = std::chrono::steady_clock::now();
    broadphase_.calculateOverlappingPairs(nullptr);
    step_only_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  [[nodiscard]] double step_only_seconds() const override { return step_only_; }
  [[nodiscard]] std::uint64_t pairs() const override {
    return static_cast<std::uint64_t>(
        const_cast<btDbvtBroadphase&>(broadphase_).getOverlappingPairCache()->getNumOverlappingPairs());
  }
  [[nodiscard]] std::uint64_t begins() const override { return events_.begins; }
  [[nodiscard]] std::uint64_t ends() const override { return events_.ends; }

 private:
  EventCounter events_;
  btDbvtBroadphase broadphase_;
  std::vector<btBroadphaseProxy*> proxies_;  // by object number
  double step_only_ = 0;
};

}  // namespace

std::unique_ptr<System> make_bullet(std::uint32_t objects) { return std::make_unique<BulletSystem>(objects); }

}  // namespace sweepgrid::bench
