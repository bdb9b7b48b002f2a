#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "baselines/peer_system.hpp"

namespace sweepgrid::baselines {

/// A whole scene in memory, so that reading it is no part of what is timed.
struct SceneScript {
  std::string scene;              ///< what read_script() was asked for
  std::uint32_t objects = 0;      ///< numbers are below this
  std::uint32_t live = 0;         ///< objects after the last step
  std::vector<ScriptStep> steps;  ///< the first inserts what is there at the start
  ScriptStep removal;             ///< after the last step: every second object goes
};

/// Reads at most `steps` steps after the start. Throws what open_scene() throws.
[[nodiscard]] SceneScript read_script(const std::string& scene, std::uint64_t steps);

}  // namespace sweepgrid::baselines
