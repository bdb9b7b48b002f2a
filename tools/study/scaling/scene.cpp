#include "study/scaling/scene.hpp"

#include <string_view>
#include <unordered_map>

#include <fmt/format.h>

#include "cli/rounded_step.hpp"
#include "scenes/generator_params.hpp"
#include "scenes/open_scene.hpp"
#include "scenes/scene_error.hpp"

namespace sweepgrid::study {
namespace {

/// Numbers objects in the order of their first appearance.
class Numbering {
 public:
  std::vector<std::uint32_t> numbers(const std::vector<SceneKey>& keys) {
    std::vector<std::uint32_t> result;
    result.reserve(keys.size());
    for (const SceneKey key : keys) {
      result.push_back(numbers_.try_emplace(key, static_cast<std::uint32_t>(numbers_.size())).first->second);
    }
    return result;
  }
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(numbers_.size()); }

 private:
  std::unordered_map<SceneKey, std::uint32_t> numbers_;
};

std::vector<Box<float, 3>> rounded(const std::vector<SceneBox>& boxes) {
  std::vector<Box<float, 3>> result;
  result.reserve(boxes.size());
  for (const SceneBox& box : boxes) result.push_back(round_box<float, 3>(box));
  return result;
}

}  // namespace

ScalingScene read_scaling_scene(const std::string& name, std::uint64_t steps) {
  const auto source = open_scene(name);
  ScalingScene scene;
  scene.name = name;
  scene.dim = source->info().dim;
  Numbering numbering;
  SceneStep ops;
  for (std::uint64_t read = 0; read <= steps && source->next(ops); ++read) {
    ScalingStep step{numbering.numbers(ops.erased), numbering.numbers(ops.inserted), rounded(ops.inserted_boxes),
                     numbering.numbers(ops.updated), rounded(ops.updated_boxes)};
    if (read == 0 || step.changes() > 0) scene.steps.push_back(std::move(step));
  }
  scene.objects = numbering.size();
  if (scene.steps.size() < 2) throw SceneError(fmt::format("{}: nothing changes after the start", name));
  return scene;
}

std::string grown_scene(const std::string& name, std::uint64_t factor) {
  const auto params = parse_generator(name);
  if (!params) throw SceneError(fmt::format("{}: a recording cannot grow with the threads (--weak)", name));
  const std::size_t colon = name.find(':');
  std::string grown = name.substr(0, colon) + fmt::format(":n={}", params->n * factor);
  std::string_view rest = colon == std::string::npos ? std::string_view() : std::string_view(name).substr(colon + 1);
  while (!rest.empty()) {
    const std::size_t comma = rest.find(',');
    const std::string_view entry = rest.substr(0, comma);
    rest = comma == std::string_view::npos ? std::string_view() : rest.substr(comma + 1);
    if (!entry.starts_with("n=")) grown += fmt::format(",{}", entry);
  }
  return grown;
}

}  // namespace sweepgrid::study
