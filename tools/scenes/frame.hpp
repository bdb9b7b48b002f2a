#pragma once

#include <optional>
#include <vector>

#include "scenes/scene_source.hpp"

namespace sweepgrid {

/// All objects of one moment of a recording.
struct Frame {
  std::vector<SceneKey> keys;
  std::vector<SceneBox> boxes;  ///< of keys[i]

  void clear() {
    keys.clear();
    boxes.clear();
  }

  /// Brings the objects into the order of their keys. Returns a key that is there twice, if any.
  std::optional<SceneKey> sort();
};

/// Writes to `step` what turns `before` into `after`; both are sorted.
void diff_frames(const Frame& before, const Frame& after, SceneStep& step);

}  // namespace sweepgrid
