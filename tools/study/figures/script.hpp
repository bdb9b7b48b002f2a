#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <sweepgrid/sap/ids.hpp>

#include "scenes/scene_script.hpp"

namespace sweepgrid::study {

/// A generated scene, read to its end before anything is timed.
struct Script {
  std::uint32_t numbers = 0;      ///< all objects' numbers are below
  double world_edge = 0;          ///< the longest
  double mean_density = 0;        ///< objects per unit of volume (area in a flat scene)
  std::vector<ScriptStep> steps;  ///< [0] is the start
  std::vector<PairKey> pairs;     ///< that overlap after the last step, sorted: found by the OverlapOracle
};

/// `scene`: a generator with its parameters, as `sweepgrid run` takes it. Throws SceneError.
[[nodiscard]] Script make_script(const std::string& scene);

}  // namespace sweepgrid::study
