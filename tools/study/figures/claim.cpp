#include "study/figures/claim.hpp"

#include <cmath>

#include <fmt/format.h>

namespace sweepgrid::study {
namespace {

std::string number(double value, int digits) {
  return std::isinf(value) ? (value > 0 ? "never" : "-inf") : fmt::format("{:.{}f}", value, digits);
}

std::string here(const Claim& claim) {
  if (!claim.beyond_us.empty()) return "–";
  if (!claim.value) return fmt::format("{}: not in this run", claim.what);
  std::string text = fmt::format("{}: {}", claim.what, number(*claim.value, claim.digits));
  if (claim.low && claim.high) {
    text += fmt::format(" ({} to {})", number(*claim.low, claim.digits), number(*claim.high, claim.digits));
  }
  return text;
}

std::string rule(const Claim& claim) {
  if (!claim.beyond_us.empty()) return "–";
  const auto& [low, high] = claim.band;
  if (std::isinf(high)) return fmt::format("at least {}", number(low, claim.digits));
  if (std::isinf(low)) return fmt::format("at most {}", number(high, claim.digits));
  if (low == high) return fmt::format("exactly {}", number(low, claim.digits));
  return fmt::format("{} to {}", number(low, claim.digits), number(high, claim.digits));
}

}  // namespace

Verdict judge(const Claim& claim) {
  if (!claim.beyond_us.empty()) return Verdict::kNotComparable;
  if (!claim.value) return Verdict::kNotMeasured;
  return claim.band.low <= *claim.value && *claim.value <= claim.band.high ? Verdict::kAgrees : Verdict::kDiffers;
}

std::string verdict_text(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAgrees:
      return "agrees";
    case Verdict::kDiffers:
      return "differs";
    case Verdict::kNotComparable:
      return "not comparable";
    case Verdict::kNotMeasured:
      break;
  }
  return "not measured";
}

std::string reason(const Claim& claim) {
  if (judge(claim) == Verdict::kNotComparable) return claim.beyond_us;
  if (judge(claim) != Verdict::kDiffers) return "";
  return *claim.value < claim.band.low ? claim.why_less : claim.why_more;
}

Table claims_table(const std::vector<Claim>& claims) {
  Table table;
  table.id = "claims";
  table.title = "The paper says / here";
  table.caption =
      "In brackets the least and the most of all rounds, or the 95 % interval of an exponent. A claim agrees "
      "when the median is within what counts as agreement.";
  table.columns = {"Where", "The paper says", "Here", "Counts as agreement", "Verdict", "Reason"};
  for (const Claim& claim : claims) {
    table.rows.push_back(
        {{claim.where}, {claim.says}, {here(claim)}, {rule(claim)}, {verdict_text(judge(claim))}, {reason(claim)}});
  }
  return table;
}

}  // namespace sweepgrid::study
