#include "tune/candidate.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <sweepgrid/engine/config_json.hpp>

#include "setup/setup_json.hpp"
#include "study/accuracy/configurations.hpp"

namespace sweepgrid::tune {

std::string axes_name(const std::vector<std::size_t>& axes) {
  std::string name;
  for (const std::size_t axis : axes) name += "xyz"[axis];
  return name;
}

std::string door_name(Door door) {
  return is_float(door) ? fmt::format("{}, {}", scalar_name(door), rounding_name(door)) : scalar_name(door);
}

std::string envelope_name(const EnvelopeChoice& envelope) {
  if (!envelope) return "no envelopes";
  std::vector<std::string> parts;
  if (envelope->stride > 1) parts.push_back(fmt::format("stride {}", envelope->stride));
  if (envelope->swept) parts.emplace_back("swept");
  if (envelope->margin > 0) parts.push_back(fmt::format("margin {:.4g}", envelope->margin));
  if (envelope->margin_steps > 0) parts.push_back(fmt::format("margin of {:.4g} steps", envelope->margin_steps));
  if (envelope->stride > 1 && envelope->on_violation == OnViolation::kQuery) parts.emplace_back("queries");
  if (envelope->exact) parts.emplace_back("exact");
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string cells_name(const CellChoice& cells) {
  std::string name = json_members::name_of(cells.kind);
  if (cells.kind != CellKind::kRows) name += " cells";
  if (cells.population) name += fmt::format(" of {}", *cells.population);
  if (cells.reduction == Reduction::kWitnessCounts) name += ", witness counts";
  return name;
}

std::string Candidate::name() const {
  return fmt::format("{}; {}; {}; {}", door_name(door), axes_name(axes), envelope_name(envelope), cells_name(cells));
}

EngineSetup Candidate::setup(const SceneSample& sample, int threads) const {
  EngineSetup setup;
  // Objects that go on moving beyond a sample are not to fall off the ends of the type at once.
  constexpr double kRoom = 0.125;  // of each edge, on both sides
  SceneBox world = sample.world;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double room = kRoom * (world.max[axis] - world.min[axis]);
    world.min[axis] -= room, world.max[axis] += room;
  }
  setup.treatment = covering(door, world);
  setup.treatment.axes = axes;
  setup.config.cell.kind = cells.kind;
  setup.config.cell_population = cells.population;
  setup.config.reduction = cells.reduction;
  setup.config.envelope = envelope;
  if (envelope) setup.config.envelope->margin *= sample.width * scale_of(setup.treatment);
  setup.config.threads = threads;
  return setup;
}

CandidateSpace candidate_space(const SceneInfo& scene) {
  CandidateSpace space;
  space.axes = {{0, 1}};
  if (scene.dim == 3) space.axes = {{0, 1, 2}, {0, 1}, {0, 2}, {1, 2}};
  space.doors = {Door::kDouble, Door::kFloatNearest, Door::kFloatOutward, Door::kInt32, Door::kInt16};
  std::vector<std::string> seen;
  for (const study::Configuration& configuration : study::configurations()) {
    const std::string name = envelope_name(configuration.envelope);
    if (std::find(seen.begin(), seen.end(), name) != seen.end()) continue;
    seen.push_back(name);
    space.envelopes.push_back(configuration.envelope);
  }
  space.envelopes.push_back(EnvelopeOptions{.margin = 0.002});  // for what only trembles
  for (const CellKind kind : {CellKind::kRows, CellKind::kBatch, CellKind::kSegmented}) {
    for (const std::optional<int> population : {std::optional<int>(), std::optional<int>(8), std::optional<int>(32)}) {
      space.cells.push_back({kind, population});
    }
  }
  space.cells.push_back({CellKind::kRows, std::nullopt, Reduction::kWitnessCounts});
  return space;
}

Guarantee promised(const Candidate& candidate, const SceneInfo& scene, const Demand& demand) {
  EngineSetup setup;
  setup.treatment.door = candidate.door;
  setup.treatment.axes = candidate.axes;
  setup.config.envelope = candidate.envelope;
  return guarantee(setup, scene, demand.truth, true);
}

bool may_meet(const Candidate& candidate, const SceneInfo& scene, const Demand& demand) {
  const Guarantee promise = promised(candidate, scene, demand);
  if (demand.missed <= 0 && promise == Guarantee::kMayMiss) return false;
  return !demand.extra || *demand.extra > 0 || promise == Guarantee::kExact;
}

}  // namespace sweepgrid::tune
