#pragma once

#include <unordered_map>
#include <vector>

#include "accuracy/scene_pair.hpp"
#include "scenes/scene_source.hpp"

namespace sweepgrid {

/// What overlaps, found by other means than the engine's and from nothing but the boxes: sort by min x and sweep.
/// Comparisons are in double, which is exact for float boxes, too.
class OverlapOracle {
 public:
  void insert(SceneKey key, const SceneBox& box) { boxes_[key] = box; }
  void update(SceneKey key, const SceneBox& box) { boxes_[key] = box; }
  void erase(SceneKey key) { boxes_.erase(key); }
  void apply(const SceneStep& step);

  [[nodiscard]] const SceneBox& box(SceneKey key) const { return boxes_.at(key); }
  [[nodiscard]] bool contains(SceneKey key) const { return boxes_.contains(key); }

  /// All pairs whose closed boxes overlap, sorted. O(n log n + n k), k: boxes whose x extents meet.
  [[nodiscard]] std::vector<ScenePair> pairs() const;

 private:
  std::unordered_map<SceneKey, SceneBox> boxes_;
};

}  // namespace sweepgrid
