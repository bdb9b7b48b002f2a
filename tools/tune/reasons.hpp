#pragma once

#include <string>
#include <vector>

#include "tune/contest.hpp"
#include "tune/scene_facts.hpp"
#include "tune/tuner.hpp"

namespace sweepgrid::tune {

/// Why an envelope need not be measured, from counts; empty where that is to be seen.
[[nodiscard]] std::string why_not_worthwhile(const EnvelopeOptions& envelope, const SceneSample& sample,
                                             const SceneFacts& facts);

/// Why a contender is not the best.
[[nodiscard]] std::string why_rejected(const Contender& other, const Contender& best, const Demand& demand);

/// Why the best is what it is, in each respect.
[[nodiscard]] std::vector<Reason> reasons(const SceneSample& sample, const SceneFacts& facts, const Demand& demand,
                                          const Contest& contest, const Contender& best);

}  // namespace sweepgrid::tune
