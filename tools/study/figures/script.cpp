#include "study/figures/script.hpp"

#include <algorithm>
#include <memory>

#include "cli/overlap_oracle.hpp"
#include "cli/rounded_step.hpp"
#include "scenes/open_scene.hpp"

namespace sweepgrid::study {
namespace {

std::vector<std::uint32_t> narrowed(const std::vector<SceneKey>& keys) { return {keys.begin(), keys.end()}; }

void tell(OverlapOracle& oracle, const SceneStep& step) {
  for (const SceneKey key : step.erased) oracle.erase(key);
  for (std::size_t i = 0; i < step.inserted.size(); ++i) oracle.insert(step.inserted[i], step.inserted_boxes[i]);
  for (std::size_t i = 0; i < step.updated.size(); ++i) oracle.update(step.updated[i], step.updated_boxes[i]);
}

}  // namespace

Script make_script(const std::string& scene) {
  const std::unique_ptr<SceneSource> source = open_scene(scene);
  Script script;
  OverlapOracle oracle;
  SceneStep step;
  while (source->next(step)) {
    ScriptStep& own = script.steps.emplace_back();
    own.erased = narrowed(step.erased);
    own.inserted = narrowed(step.inserted);
    own.updated = narrowed(step.updated);
    round_boxes(step.inserted_boxes, own.inserted_boxes);
    round_boxes(step.updated_boxes, own.updated_boxes);
    tell(oracle, step);
    for (const std::uint32_t number : own.inserted) script.numbers = std::max(script.numbers, number + 1);
  }
  double volume = 1;
  for (int axis = 0; axis < source->info().dim; ++axis) {
    script.world_edge = std::max(script.world_edge, source->info().bounds->max[axis]);
    volume *= source->info().bounds->max[axis];
  }
  script.mean_density = static_cast<double>(script.steps[0].inserted.size()) / volume;
  for (const ScenePair& pair : oracle.pairs()) {
    script.pairs.emplace_back(static_cast<ObjectId>(pair.first), static_cast<ObjectId>(pair.second));
  }
  return script;
}

}  // namespace sweepgrid::study
