// Bytes as the text that asks for a generated scene: refused by name, or parameters that their own description gives
// again; and scenes of few objects keep the contract of scenes, and are the same a second time.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "finding.hpp"
#include "scene_check.hpp"
#include "scenes/generated_scene.hpp"
#include "scenes/generator_params.hpp"

namespace sweepgrid::fuzz {
namespace {

void check_description(const GeneratorParams& params) {
  std::string text = "uniform:";
  auto described = describe(params);
  if (planted("bit")) described.front().second = "77";
  for (const auto& [key, value] : described) text += (text.back() == ':' ? "" : ",") + key + "=" + value;
  const auto again = parse_generator(text);
  require(again.has_value() && describe(*again) == describe(params), "the description is of other parameters: " + text);
}

void play(const std::string& spec, GeneratorParams params) {
  params.n = std::min<std::uint64_t>(params.n, 60);
  params.covers = std::min<std::uint64_t>(params.covers, 5);
  params.clusters = std::min<std::uint64_t>(params.clusters, 20);
  params.steps = std::min<std::uint64_t>(params.steps, 4);
  // A bad box is told apart from no box by generators that make them alone.
  const bool bad_boxes = params.nan > 0 || params.inverted > 0;
  try {
    GeneratedScene scene(spec, params);
    GeneratedScene again(spec, params);
    SceneCheck check(bad_boxes);
    SceneStep step;
    SceneStep step_again;
    std::uint64_t steps = 0;
    for (; scene.next(step); ++steps) {
      require(steps <= params.steps, "more steps than asked for");
      check.take(step);
      require(again.next(step_again) && step_again.updated == step.updated && step_again.inserted == step.inserted &&
                  step_again.erased == step.erased,
              "another scene the second time");
      require(bad_boxes ||
                  (step_again.updated_boxes == step.updated_boxes && step_again.inserted_boxes == step.inserted_boxes),
              "other boxes the second time");
    }
    require(steps == params.steps + 1, "fewer steps than asked for");
  } catch (const SceneError&) {  // parameters that are no good together
  }
}

}  // namespace
}  // namespace sweepgrid::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sweepgrid;        // NOLINT(google-build-using-namespace)
  using namespace sweepgrid::fuzz;  // NOLINT(google-build-using-namespace)
  const std::string spec(data, data + size);
  std::optional<GeneratorParams> params;
  try {
    params = parse_generator(spec);
  } catch (const SceneError& error) {
    require(std::string(error.what()).starts_with("generator "), "an error that does not name the generator");
    return 0;
  }
  if (!params) return 0;
  check_description(*params);
  play(spec, *params);
  return 0;
}
