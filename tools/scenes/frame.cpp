#include "scenes/frame.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace sweepgrid {

std::optional<SceneKey> Frame::sort() {
  if (!std::is_sorted(keys.begin(), keys.end())) {
    std::vector<std::size_t> order(keys.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) { return keys[a] < keys[b]; });
    Frame sorted;
    sorted.keys.reserve(keys.size());
    sorted.boxes.reserve(keys.size());
    for (const std::size_t from : order) {
      sorted.keys.push_back(keys[from]);
      sorted.boxes.push_back(boxes[from]);
    }
    *this = std::move(sorted);
  }
  const auto twice = std::adjacent_find(keys.begin(), keys.end());
  if (twice == keys.end()) return std::nullopt;
  return *twice;
}

void diff_frames(const Frame& before, const Frame& after, SceneStep& step) {
  step.clear();
  std::size_t old_index = 0;
  for (std::size_t i = 0; i < after.keys.size(); ++i) {
    const SceneKey key = after.keys[i];
    while (old_index < before.keys.size() && before.keys[old_index] < key) {
      step.erased.push_back(before.keys[old_index++]);
    }
    const bool lived = old_index < before.keys.size() && before.keys[old_index] == key;
    if (!lived) {
      step.inserted.push_back(key);
      step.inserted_boxes.push_back(after.boxes[i]);
      continue;
    }
    if (before.boxes[old_index] != after.boxes[i]) {
      step.updated.push_back(key);
      step.updated_boxes.push_back(after.boxes[i]);
    }
    ++old_index;
  }
  step.erased.insert(step.erased.end(), before.keys.begin() + static_cast<std::ptrdiff_t>(old_index),
                     before.keys.end());
}

}  // namespace sweepgrid
