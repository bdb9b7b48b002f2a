#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "accuracy/pair_log.hpp"
#include "baselines/dynamic_octree.hpp"
#include "baselines/peer_system.hpp"

namespace sweepgrid::accuracy {

/// The dynamic octree of tools/baselines.
class OctreeSystem final : public baselines::System {
 public:
  /// Refuses bad input object by object, with std::invalid_argument.
  void queue(const ScriptStep& step) override {
    for (const std::uint32_t object : step.erased) octree_.erase(object);
    for (std::size_t i = 0; i < step.inserted.size(); ++i) octree_.insert(step.inserted[i], step.inserted_boxes[i]);
    for (std::size_t i = 0; i < step.updated.size(); ++i) octree_.update(step.updated[i], step.updated_boxes[i]);
  }

  void step() override {
    const auto& events = octree_.step();
    for (const auto& [a, b] : events.ends) log_.end({a, b});
    for (const auto& [a, b] : events.begins) log_.begin({a, b});
    totals_.begins += events.begins.size();
    totals_.ends += events.ends.size();
  }

  [[nodiscard]] std::vector<baselines::ObjectPair> pairs() const override { return log_.pairs(); }
  [[nodiscard]] std::optional<baselines::EventTotals> events() const override { return totals_; }
  [[nodiscard]] std::optional<std::uint64_t> counted_bytes() const override { return octree_.bytes(); }

 private:
  baselines::DynamicOctree<float> octree_;
  PairLog log_;
  baselines::EventTotals totals_;
};

}  // namespace sweepgrid::accuracy
