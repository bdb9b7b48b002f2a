#include "study/figures/script.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "cli/overlap_oracle.hpp"

namespace sweepgrid::study {
Script make_script(const std::string& scene) {
  SceneScript read = read_script(scene, std::numeric_limits<std::uint64_t>::max());
  Script script;
  script.numbers = read.objects;
  script.steps = std::move(read.steps);
  OverlapOracle oracle;
  for (const ScriptStep& step : script.steps) oracle.apply(scene_step(step));
  double volume = 1;
  for (int axis = 0; axis < read.info.dim; ++axis) {
    script.world_edge = std::max(script.world_edge, read.info.bounds->max[axis]);
    volume *= read.info.bounds->max[axis];
  }
  script.mean_density = static_cast<double>(script.steps[0].inserted.size()) / volume;
  for (const ScenePair& pair : oracle.pairs()) {
    script.pairs.emplace_back(static_cast<ObjectId>(pair.first), static_cast<ObjectId>(pair.second));
  }
  return script;
}

}  // namespace sweepgrid::study
