#include "study/figures/paper_claims.hpp"

#include <utility>

namespace sweepgrid::study {

Claim with(Claim claim, const std::optional<Spread>& spread) {
  if (!spread) return claim;
  claim.value = spread->median;
  claim.low = spread->low;
  claim.high = spread->high;
  return claim;
}

Claim with(Claim claim, const std::optional<PowerLaw>& law) {
  if (!law) return claim;
  claim.value = law->exponent;
  claim.low = law->exponent_low;
  claim.high = law->exponent_high;
  return claim;
}

Claim with(Claim claim, const std::optional<double>& value) {
  claim.value = value;
  return claim;
}

std::vector<Claim> paper_claims(const Results& results) {
  std::vector<Claim> claims;
  for (const auto part : {claims_on_growth, claims_on_enhancements, claims_on_results}) {
    for (Claim& claim : part(results)) claims.push_back(std::move(claim));
  }
  return claims;
}

}  // namespace sweepgrid::study
