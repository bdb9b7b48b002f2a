#pragma once

#include <unordered_map>
#include <utility>
#include <vector>

#include <sweepgrid/engine/events.hpp>

#include "scenes/scene_source.hpp"

namespace sweepgrid {

using ScenePair = Pair<SceneKey>;

/// By key of the first, then of the second.
struct ScenePairOrder {
  bool operator()(const ScenePair& a, const ScenePair& b) const {
    return a.first != b.first ? a.first < b.first : a.second < b.second;
  }
};

/// What overlaps, found by other means than the engine's and from nothing but the boxes: sort by min x and sweep.
/// Comparisons are in double, which is exact for float boxes, too.
class OverlapOracle {
 public:
  void insert(SceneKey key, const SceneBox& box) { boxes_[key] = box; }
  void update(SceneKey key, const SceneBox& box) { boxes_[key] = box; }
  void erase(SceneKey key) { boxes_.erase(key); }

  [[nodiscard]] const SceneBox& box(SceneKey key) const { return boxes_.at(key); }
  [[nodiscard]] bool contains(SceneKey key) const { return boxes_.contains(key); }

  /// All pairs whose closed boxes overlap, sorted. O(n log n + n k), k: boxes whose x extents meet.
  [[nodiscard]] std::vector<ScenePair> pairs() const;

 private:
  std::unordered_map<SceneKey, SceneBox> boxes_;
};

}  // namespace sweepgrid
