#pragma once

#include <span>

namespace sweepgrid::study {

/// y = factor * x^exponent.
struct PowerLaw {
  double factor = 0;
  double exponent = 0;
  double exponent_low = 0;  ///< the 95 % interval of the exponent
  double exponent_high = 0;

  [[nodiscard]] double operator()(double x) const;
};

/// Least squares of log y over log x; the interval is that of Student's t for normal errors of log y.
/// Throws std::invalid_argument for fewer than three points, for spans of different sizes, for an x or y that is not
/// positive and finite, and when all x are the same.
[[nodiscard]] PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y);

}  // namespace sweepgrid::study
