#pragma once

#include <cstdint>
#include <string>

#include "scenes/scene_script.hpp"

namespace sweepgrid::study {

/// Reads at most `steps` steps after the start, and keeps those that change anything. Throws what open_scene() throws,
/// and SceneError when nothing changes after the start.
[[nodiscard]] SceneScript read_scaling_scene(const std::string& name, std::uint64_t steps);

/// The generated scene `name` with `factor` times as many objects. Throws SceneError for a recording, which cannot
/// grow.
[[nodiscard]] std::string grown_scene(const std::string& name, std::uint64_t factor);

}  // namespace sweepgrid::study
