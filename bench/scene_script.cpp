#include "scene_script.hpp"

#include <unordered_map>

#include "scenes/open_scene.hpp"

namespace sweepgrid::bench {
namespace {

FloatBox rounded(const SceneBox& box) {
  FloatBox out;
  for (int axis = 0; axis < 3; ++axis) {
    out.min[axis] = static_cast<float>(box.min[axis]);
    out.max[axis] = static_cast<float>(box.max[axis]);
  }
  return out;
}

}  // namespace

SceneScript read_script(const std::string& scene, std::uint64_t steps) {
  const auto source = open_scene(scene);
  SceneScript script;
  script.name = scene;
  std::unordered_map<SceneKey, std::uint32_t> numbers;
  SceneStep step;
  while (script.steps.size() <= steps && source->next(step)) {
    ScriptStep& out = script.steps.emplace_back();
    for (const SceneKey key : step.erased) out.erased.push_back(numbers.at(key));
    for (std::size_t i = 0; i < step.inserted.size(); ++i) {
      const auto number = numbers.try_emplace(step.inserted[i], script.objects);
      script.objects += number.second ? 1 : 0;
      out.inserted.push_back(number.first->second);
      out.inserted_boxes.push_back(rounded(step.inserted_boxes[i]));
    }
    for (std::size_t i = 0; i < step.updated.size(); ++i) {
      out.updated.push_back(numbers.at(step.updated[i]));
      out.updated_boxes.push_back(rounded(step.updated_boxes[i]));
    }
  }
  return script;
}

}  // namespace sweepgrid::bench
