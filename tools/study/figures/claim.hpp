#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "study/report.hpp"

namespace sweepgrid::study {

/// The values that count as agreement, both ends included.
struct Band {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

enum class Verdict {
  kAgrees,
  kDiffers,
  kNotComparable,  ///< nothing here can be held against it
  kNotMeasured     ///< not in this run
};

/// A sentence of the paper and what was found. Whether they agree is judged, never typed in.
struct Claim {
  std::string where;                 ///< section or figure
  std::string says;                  ///< the paper, in other words
  std::string what;                  ///< what `value` is
  std::optional<double> value = {};  ///< what the rule judges; absent: not measured
  std::optional<double> low = {};    ///< its spread or interval
  std::optional<double> high = {};
  Band band = {};
  std::string why_less = {};   ///< the reason, where the value is below the band
  std::string why_more = {};   ///< where it is above
  std::string beyond_us = {};  ///< not empty: why nothing here can be held against the claim
  int digits = 2;              ///< behind the point
};

/// Agrees when the value is within the band; its spread decides nothing.
[[nodiscard]] Verdict judge(const Claim& claim);
[[nodiscard]] std::string verdict_text(Verdict verdict);

/// Why a claim differs or is not comparable; empty when it agrees.
[[nodiscard]] std::string reason(const Claim& claim);

/// The table "the paper says / here": a row for each claim.
[[nodiscard]] Table claims_table(const std::vector<Claim>& claims);

}  // namespace sweepgrid::study
