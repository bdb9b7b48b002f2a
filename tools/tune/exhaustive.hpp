#pragma once

#include <cstddef>

#include "tune/candidate.hpp"
#include "tune/demand.hpp"
#include "tune/scene_sample.hpp"
#include "tune/trial.hpp"

namespace sweepgrid::tune {

/// What measuring everything over a whole scene found.
struct ExhaustiveResult {
  std::size_t measured = 0;   ///< candidates, a round each
  std::size_t ruled_out = 0;  ///< candidates whose axes leave so many pairs that the narrow phase alone is dearer
  double seconds = 0;         ///< processor time for all of these; reading is up to the caller
  Candidate best;             ///< the cheapest of the last rounds
  Trial best_trial;
  Trial chosen_trial;  ///< of the candidate to compare with, in the same rounds
};

/// Measures every candidate that promises what the demand wants, one round over `whole`, and then those that were ahead
/// and `chosen` in turn for `last_rounds` more.
[[nodiscard]] ExhaustiveResult search_exhaustively(const SceneSample& whole, const Demand& demand,
                                                   const Candidate& chosen, const PlayRound& play, int last_rounds);

}  // namespace sweepgrid::tune
