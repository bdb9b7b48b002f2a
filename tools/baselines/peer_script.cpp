#include "baselines/peer_script.hpp"

#include <unordered_map>

#include "cli/rounded_step.hpp"
#include "scenes/open_scene.hpp"

namespace sweepgrid::baselines {
namespace {

/// Numbers the objects in the order of their first appearance.
class Numbering {
 public:
  std::uint32_t number(SceneKey key) {
    return numbers_.try_emplace(key, static_cast<std::uint32_t>(numbers_.size())).first->second;
  }
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(numbers_.size()); }

 private:
  std::unordered_map<SceneKey, std::uint32_t> numbers_;
};

ScriptStep numbered(const SceneStep& step, Numbering& numbering) {
  ScriptStep out;
  for (const SceneKey key : step.erased) out.erased.push_back(numbering.number(key));
  for (const SceneKey key : step.inserted) out.inserted.push_back(numbering.number(key));
  for (const SceneKey key : step.updated) out.updated.push_back(numbering.number(key));
  for (const SceneBox& box : step.inserted_boxes) out.inserted_boxes.push_back(round_box<float, 3>(box));
  for (const SceneBox& box : step.updated_boxes) out.updated_boxes.push_back(round_box<float, 3>(box));
  return out;
}

}  // namespace

SceneScript read_script(const std::string& scene, std::uint64_t steps) {
  const auto source = open_scene(scene);
  SceneScript script;
  script.scene = scene;
  Numbering numbering;
  std::vector<char> alive;
  SceneStep step;
  while (script.steps.size() <= steps && source->next(step)) {
    const ScriptStep& added = script.steps.emplace_back(numbered(step, numbering));
    alive.resize(numbering.size());
    for (const std::uint32_t object : added.erased) alive[object] = 0;
    for (const std::uint32_t object : added.inserted) alive[object] = 1;
  }
  script.objects = numbering.size();
  for (std::uint32_t object = 0; object < script.objects; ++object) {
    if (alive[object] != 0 && script.live++ % 2 != 0) script.removal.erased.push_back(object);
  }
  return script;
}

}  // namespace sweepgrid::baselines
