#pragma once

#include <optional>
#include <string>

#include "study/figures/results.hpp"

namespace sweepgrid::study {

/// Seconds per further x, between `from` and `to`.
[[nodiscard]] std::optional<double> slope(const Results& results, const std::string& figure, const std::string& system,
                                          double from, double to);

[[nodiscard]] std::optional<double> quotient(const std::optional<double>& above, const std::optional<double>& below);

/// What a step consists of between `from` and `to`: what a batch and a segmented system pay anyhow, and for each
/// further `unit`.
[[nodiscard]] std::string cost_text(const Results& results, const std::string& figure, const std::string& batch,
                                    const std::string& segmented, double from, double to, const char* unit);

/// How often cells of the grids pass over all of their lists at `x`, by exact counts.
[[nodiscard]] std::string sorts_text(const Results& results, const std::string& figure, double x);

/// Where a presorted system does worst beside the better of batch and segmented lists.
struct Worst {
  double x = 0;
  double ratio = 0;              ///< to the better one's time
  bool batch_is_better = false;  ///< than segmented lists, there
  double beside_plain = 0;       ///< to the time of segmented lists without presorting, there
  std::string work;              ///< what it and batch do in a step there, by exact counts
};

[[nodiscard]] std::optional<Worst> presorted_at_worst(const Results& results, const std::string& figure,
                                                      const std::string& batch, const std::string& segmented,
                                                      const std::string& presorted);
[[nodiscard]] std::string at_text(const std::optional<Worst>& worst);
[[nodiscard]] std::optional<double> ratio_of(const std::optional<Worst>& worst);
[[nodiscard]] std::string presorted_reason(const std::optional<Worst>& worst);

}  // namespace sweepgrid::study
