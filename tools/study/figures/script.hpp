#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/sap/ids.hpp>

namespace sweepgrid::study {

using FloatBox = Box<float, 3>;

/// One step of a scene in the precision of the systems. An object's number is its key: no number comes back.
struct ScriptStep {
  std::vector<std::uint32_t> erased;
  std::vector<std::uint32_t> inserted;
  std::vector<FloatBox> inserted_boxes;
  std::vector<std::uint32_t> updated;
  std::vector<FloatBox> updated_boxes;
};

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
