#include "study/accuracy/configurations.hpp"

#include <algorithm>
#include <stdexcept>

namespace sweepgrid::study {

const std::vector<Configuration>& configurations() {
  using enum OnViolation;
  // Margins by displacement of 2 * (stride - 1) are what a stride needs.
  static const std::vector<Configuration> all = {
      {"double"},
      {"float, nearest", Door::kFloatNearest},
      {"float, outward", Door::kFloatOutward},
      {"32 bits", Door::kInt32},
      {"16 bits", Door::kInt16},
      {"margin 0.02", Door::kDouble, EnvelopeOptions{.margin = 0.02}},
      {"margin 0.1", Door::kDouble, EnvelopeOptions{.margin = 0.1}},
      {"margin 0.4", Door::kDouble, EnvelopeOptions{.margin = 0.4}},
      {"margin 0.02, exact", Door::kDouble, EnvelopeOptions{.margin = 0.02, .exact = true}},
      {"margin 0.1, exact", Door::kDouble, EnvelopeOptions{.margin = 0.1, .exact = true}},
      {"margin 0.4, exact", Door::kDouble, EnvelopeOptions{.margin = 0.4, .exact = true}},
      {"swept", Door::kDouble, EnvelopeOptions{.swept = true}},
      {"swept, margin 0.1", Door::kDouble, EnvelopeOptions{.margin = 0.1, .swept = true}},
      {"stride 2", Door::kDouble, EnvelopeOptions{.stride = 2}},
      {"stride 4", Door::kDouble, EnvelopeOptions{.stride = 4}},
      {"stride 8", Door::kDouble, EnvelopeOptions{.stride = 8}},
      {"stride 2, margin 0.4", Door::kDouble, EnvelopeOptions{.margin = 0.4, .stride = 2}},
      {"stride 4, margin 0.4, queries", Door::kDouble,
       EnvelopeOptions{.margin = 0.4, .stride = 4, .on_violation = kQuery}},
      {"stride 2, moving margin", Door::kDouble, EnvelopeOptions{.margin_steps = 2, .stride = 2}},
      {"stride 4, moving margin", Door::kDouble, EnvelopeOptions{.margin_steps = 6, .stride = 4}},
      {"stride 4, moving margin, queries", Door::kDouble,
       EnvelopeOptions{.margin_steps = 6, .stride = 4, .on_violation = kQuery}},
      {"stride 4, moving margin, queries, exact", Door::kDouble,
       EnvelopeOptions{.margin_steps = 6, .stride = 4, .on_violation = kQuery, .exact = true}},
      {"stride 8, moving margin, queries", Door::kDouble,
       EnvelopeOptions{.margin_steps = 14, .stride = 8, .on_violation = kQuery}},
      {"float, outward, margin 0.1", Door::kFloatOutward, EnvelopeOptions{.margin = 0.1}},
      {"float, outward, swept", Door::kFloatOutward, EnvelopeOptions{.swept = true}},
      {"16 bits, margin 0.1", Door::kInt16, EnvelopeOptions{.margin = 0.1}},
      {"16 bits, swept", Door::kInt16, EnvelopeOptions{.swept = true}},
  };
  return all;
}

const Configuration& find_configuration(std::string_view name) {
  const auto found = std::find_if(configurations().begin(), configurations().end(),
                                  [&](const Configuration& known) { return known.name == name; });
  if (found == configurations().end()) throw std::invalid_argument("no configuration '" + std::string(name) + "'");
  return *found;
}

Guarantee guarantee(const Configuration& configuration, accuracy::TruthKind truth, std::uint64_t violations) {
  EngineSetup setup;
  setup.treatment.door = configuration.door;
  setup.config.envelope = configuration.envelope;
  SceneInfo scene;
  scene.shapes = ShapeKind::kSpheres;
  return sweepgrid::guarantee(setup, scene, truth, violations > 0);
}

}  // namespace sweepgrid::study
