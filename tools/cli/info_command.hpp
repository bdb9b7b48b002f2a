#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/run_options.hpp"
#include "scenes/open_scene.hpp"

namespace sweepgrid {

/// What `sweepgrid info` was asked for.
struct InfoOptions {
  std::vector<std::string> scenes;
  SceneOptions scene;
  ScalarKind scalar = ScalarKind::kFloat;
  std::optional<std::uint64_t> steps;
};

/// `sweepgrid info`: reads each scene to its end and describes it on the standard output. Throws SceneError where one
/// cannot be read to its end, after what was read of it, and the other scenes, are described.
void info_command(const InfoOptions& options);

}  // namespace sweepgrid
