#include "study/scaling/scene.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "scenes/generator_params.hpp"
#include "scenes/scene_error.hpp"

namespace sweepgrid::study {
SceneScript read_scaling_scene(const std::string& name, std::uint64_t steps) {
  SceneScript script = read_script(name, steps);
  script.steps.erase(std::remove_if(script.steps.begin() + 1, script.steps.end(),
                                    [](const ScriptStep& step) { return step.changes() == 0; }),
                     script.steps.end());
  if (script.steps.size() < 2) throw SceneError(fmt::format("{}: nothing changes after the start", name));
  return script;
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
