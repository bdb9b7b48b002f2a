#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "accuracy/truth.hpp"

namespace sweepgrid::tune {

/// What a client asks of a configuration.
struct Demand {
  accuracy::TruthKind truth = accuracy::TruthKind::kInstants;
  double missed = 0;            ///< part of the true pairs that may be missed; with 0, what counts is the guarantee
  std::optional<double> extra;  ///< part of the reported pairs that may be none; with 0, the guarantee; absent: any
  double narrow_ns = 0;         ///< price of a reported pair
  std::string narrow_source;    ///< whose price that is
  int threads = 1;
};

/// No configuration meets a demand; what() says what came nearest.
class DemandNotMet : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// "T0", "T1", "T2".
[[nodiscard]] std::string truth_name(accuracy::TruthKind truth);
/// "missed 0, extra at most 5 %, of T0".
[[nodiscard]] std::string demand_text(const Demand& demand);

/// "5%" or "0.05". Throws std::invalid_argument unless it is within 0 and 1.
[[nodiscard]] double parse_part(const std::string& text);

}  // namespace sweepgrid::tune
