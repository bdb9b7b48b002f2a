#pragma once

#include <optional>
#include <vector>

#include "study/figures/claim.hpp"
#include "study/figures/results.hpp"

namespace sweepgrid::study {

/// Every number and claim of the paper's sections 2 to 4, in its order, with what was measured for it.
[[nodiscard]] std::vector<Claim> paper_claims(const Results& results);

/// Those of sections 2, 3 and 4, which include those of 4.2.
[[nodiscard]] std::vector<Claim> claims_on_growth(const Results& results);
[[nodiscard]] std::vector<Claim> claims_on_enhancements(const Results& results);
[[nodiscard]] std::vector<Claim> claims_on_results(const Results& results);
[[nodiscard]] std::vector<Claim> claims_on_grids(const Results& results);

/// `claim` with what was measured.
[[nodiscard]] Claim with(Claim claim, const std::optional<Spread>& spread);
[[nodiscard]] Claim with(Claim claim, const std::optional<PowerLaw>& law);
[[nodiscard]] Claim with(Claim claim, const std::optional<double>& value);

}  // namespace sweepgrid::study
