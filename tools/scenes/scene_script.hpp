#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <sweepgrid/sap/box.hpp>

#include "scenes/scene_source.hpp"

namespace sweepgrid {

using FloatBox = Box<float, 3>;

/// One step of a scene in float, with objects numbered densely: number k is always the same object while it lives. In a
/// scene of two dimensions z is [0, 0].
struct ScriptStep {
  std::vector<std::uint32_t> erased;
  std::vector<std::uint32_t> inserted;
  std::vector<FloatBox> inserted_boxes;
  std::vector<std::uint32_t> updated;
  std::vector<FloatBox> updated_boxes;

  [[nodiscard]] std::size_t changes() const { return erased.size() + inserted.size() + updated.size(); }
};

/// A whole scene in memory, so that reading it is no part of what is timed.
struct SceneScript {
  std::string scene;              ///< what read_script() was asked for
  SceneInfo info;                 ///< what the source told
  std::uint32_t objects = 0;      ///< numbers are below this
  std::uint32_t live = 0;         ///< objects after the last step
  std::vector<ScriptStep> steps;  ///< the first inserts what is there at the start
  ScriptStep removal;             ///< after the last step: every second object goes
};

/// Reads at most `steps` steps after the start. Throws what open_scene() throws.
[[nodiscard]] SceneScript read_script(const std::string& scene, std::uint64_t steps);

/// The same step for those who take scenes: keys are the numbers.
[[nodiscard]] SceneStep scene_step(const ScriptStep& step);

}  // namespace sweepgrid
