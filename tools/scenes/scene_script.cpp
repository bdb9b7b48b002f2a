#include "scenes/scene_script.hpp"

#include <algorithm>

#include "scenes/open_scene.hpp"
#include "scenes/rounded_step.hpp"
#include "scenes/scene_numbering.hpp"

namespace sweepgrid {
namespace {

std::vector<SceneBox> widened(const std::vector<FloatBox>& boxes) {
  std::vector<SceneBox> result(boxes.size());
  std::transform(boxes.begin(), boxes.end(), result.begin(), widen_box<float, 3>);
  return result;
}

std::vector<FloatBox> rounded(const std::vector<SceneBox>& boxes) {
  std::vector<FloatBox> result(boxes.size());
  std::transform(boxes.begin(), boxes.end(), result.begin(), round_box<float, 3>);
  return result;
}

}  // namespace

SceneScript read_script(const std::string& scene, std::uint64_t steps) {
  const auto source = open_scene(scene);
  SceneScript script;
  script.scene = scene;
  SceneNumbering numbering;
  std::vector<char> alive;
  SceneStep step;
  while (script.steps.size() <= steps && source->next(step)) {
    const ScriptStep& added = script.steps.emplace_back(
        ScriptStep{numbering.numbers(step.erased), numbering.numbers(step.inserted), rounded(step.inserted_boxes),
                   numbering.numbers(step.updated), rounded(step.updated_boxes)});
    alive.resize(numbering.size());
    for (const std::uint32_t object : added.erased) alive[object] = 0;
    for (const std::uint32_t object : added.inserted) alive[object] = 1;
  }
  script.info = source->info();
  script.objects = numbering.size();
  for (std::uint32_t object = 0; object < script.objects; ++object) {
    if (alive[object] != 0 && script.live++ % 2 != 0) script.removal.erased.push_back(object);
  }
  return script;
}

SceneStep scene_step(const ScriptStep& step) {
  SceneStep result;
  result.erased.assign(step.erased.begin(), step.erased.end());
  result.inserted.assign(step.inserted.begin(), step.inserted.end());
  result.inserted_boxes = widened(step.inserted_boxes);
  result.updated.assign(step.updated.begin(), step.updated.end());
  result.updated_boxes = widened(step.updated_boxes);
  return result;
}

}  // namespace sweepgrid
