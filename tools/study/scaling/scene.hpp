#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <sweepgrid/sap/box.hpp>

namespace sweepgrid::study {

/// One step of a scene, with objects numbered densely: number k is always the same object while it lives.
struct ScalingStep {
  std::vector<std::uint32_t> erased;
  std::vector<std::uint32_t> inserted;
  std::vector<Box<float, 3>> inserted_boxes;
  std::vector<std::uint32_t> updated;
  std::vector<Box<float, 3>> updated_boxes;

  [[nodiscard]] std::size_t changes() const { return erased.size() + inserted.size() + updated.size(); }
};

/// A scene in memory, so that reading it is no part of what is timed. In two dimensions z is [0, 0].
struct ScalingScene {
  std::string name;  ///< as open_scene() takes it
  int dim = 3;
  std::uint32_t objects = 0;       ///< numbers are below this
  std::vector<ScalingStep> steps;  ///< the first is the start; of the others, those that change anything
};

/// Reads at most `steps` steps after the start. Throws what open_scene() throws, and SceneError when nothing changes
/// after the start.
[[nodiscard]] ScalingScene read_scaling_scene(const std::string& name, std::uint64_t steps);

/// The generated scene `name` with `factor` times as many objects. Throws SceneError for a recording, which cannot
/// grow.
[[nodiscard]] std::string grown_scene(const std::string& name, std::uint64_t factor);

}  // namespace sweepgrid::study
