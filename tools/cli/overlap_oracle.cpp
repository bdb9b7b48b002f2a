#include "cli/overlap_oracle.hpp"

#include <algorithm>
#include <cstddef>

namespace sweepgrid {
namespace {

bool overlap_on(std::size_t axis, const SceneBox& a, const SceneBox& b) {
  return a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis];
}

}  // namespace

void OverlapOracle::apply(const SceneStep& step) {
  for (const SceneKey key : step.erased) erase(key);
  for (std::size_t i = 0; i < step.inserted.size(); ++i) insert(step.inserted[i], step.inserted_boxes[i]);
  for (std::size_t i = 0; i < step.updated.size(); ++i) update(step.updated[i], step.updated_boxes[i]);
}

std::vector<ScenePair> OverlapOracle::pairs() const {
  std::vector<std::pair<SceneBox, SceneKey>> by_x;
  by_x.reserve(boxes_.size());
  for (const auto& [key, box] : boxes_) by_x.emplace_back(box, key);
  std::sort(by_x.begin(), by_x.end(), [](const auto& a, const auto& b) { return a.first.min[0] < b.first.min[0]; });
  std::vector<ScenePair> result;
  for (std::size_t i = 0; i < by_x.size(); ++i) {
    const auto& [box, key] = by_x[i];
    for (std::size_t j = i + 1; j < by_x.size() && by_x[j].first.min[0] <= box.max[0]; ++j) {
      const auto& [other_box, other_key] = by_x[j];
      if (!overlap_on(1, box, other_box) || !overlap_on(2, box, other_box)) continue;
      result.push_back({std::min(key, other_key), std::max(key, other_key)});
    }
  }
  std::sort(result.begin(), result.end(), ScenePairOrder());
  return result;
}

}  // namespace sweepgrid
