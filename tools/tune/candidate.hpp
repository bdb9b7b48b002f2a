#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <sweepgrid/engine/config.hpp>

#include "setup/engine_setup.hpp"
#include "setup/guarantee.hpp"
#include "tune/demand.hpp"
#include "tune/scene_sample.hpp"

namespace sweepgrid::tune {

/// Cells, and how they report.
struct CellChoice {
  CellKind kind = CellKind::kRows;
  std::optional<int> population;
  Reduction reduction = Reduction::kSingleReporter;
};

/// An envelope whose margin is in widths of the scene's objects.
using EnvelopeChoice = std::optional<EnvelopeOptions>;

/// One choice in each of the four respects.
struct Candidate {
  std::vector<std::size_t> axes;
  Door door = Door::kDouble;
  EnvelopeChoice envelope;
  CellChoice cells;

  /// "float, outward; axes xy; margin 0.1; batch, 8 per cell".
  [[nodiscard]] std::string name() const;
  /// In the scene's units, or in those of its integers.
  [[nodiscard]] EngineSetup setup(const SceneSample& sample, int threads) const;
};

[[nodiscard]] std::string axes_name(const std::vector<std::size_t>& axes);
[[nodiscard]] std::string door_name(Door door);
[[nodiscard]] std::string envelope_name(const EnvelopeChoice& envelope);
[[nodiscard]] std::string cells_name(const CellChoice& cells);

/// What there is to choose from: every combination is a candidate. The first of each list is what an engine does when
/// it is told nothing.
struct CandidateSpace {
  std::vector<std::vector<std::size_t>> axes;
  std::vector<Door> doors;
  std::vector<EnvelopeChoice> envelopes;
  std::vector<CellChoice> cells;
};

/// Everything for a scene, whatever the demand. Envelopes are those of study::configurations(),
/// and a narrower margin.
[[nodiscard]] CandidateSpace candidate_space(const SceneInfo& scene);

/// What a candidate promises of the demand's truth, whatever the scene does.
[[nodiscard]] Guarantee promised(const Candidate& candidate, const SceneInfo& scene, const Demand& demand);

/// Whether it may be chosen for the demand, going by what it promises: what is left then is to be measured.
[[nodiscard]] bool may_meet(const Candidate& candidate, const SceneInfo& scene, const Demand& demand);

}  // namespace sweepgrid::tune
