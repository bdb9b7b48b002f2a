#pragma once

#include <string>
#include <vector>

#include "tune/candidate.hpp"
#include "tune/demand.hpp"
#include "tune/scene_facts.hpp"
#include "tune/scene_sample.hpp"
#include "tune/trial.hpp"

namespace sweepgrid::tune {

/// One of the choices that make a configuration.
struct Reason {
  std::string about;  ///< "numbers", "axes", "envelopes", "cells", "grid", "guarantee"
  std::string choice;
  std::string because;
};

/// What was not chosen. With 0 rounds it was not measured.
struct Rejection {
  std::string candidate;
  std::string because;
  int rounds = 0;
  double total_ms = 0;
};

struct TuneResult {
  Candidate chosen;
  Trial trial;
  Guarantee guarantee = Guarantee::kMayMiss;
  std::vector<Reason> reasons;
  std::vector<Rejection> rejected;
};

/// Finds the cheapest candidate for the demand by choosing numbers, cells, axes and envelopes one after the other,
/// twice, and trying the runners-up of each together at last. What facts rule out is not measured. Throws DemandNotMet.
[[nodiscard]] TuneResult tune(const SceneSample& sample, const SceneFacts& facts, const Demand& demand,
                              const PlayRound& play);

}  // namespace sweepgrid::tune
