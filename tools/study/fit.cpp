#include "study/fit.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <boost/math/distributions/students_t.hpp>

namespace sweepgrid::study {
namespace {

double checked_log(double value) {
  if (!(value > 0) || !std::isfinite(value)) {
    throw std::invalid_argument("fit_power_law: a coordinate is not positive and finite");
  }
  return std::log(value);
}

}  // namespace

double PowerLaw::operator()(double x) const { return factor * std::pow(x, exponent); }

PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size()) throw std::invalid_argument("fit_power_law: as many x as y, please");
  if (x.size() < 3) throw std::invalid_argument("fit_power_law: fewer than three points");
  const auto count = static_cast<double>(x.size());
  double mean_x = 0;
  double mean_y = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += checked_log(x[i]) / count;
    mean_y += checked_log(y[i]) / count;
  }
  double xx = 0;
  double xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = std::log(x[i]) - mean_x;
    xx += dx * dx;
    xy += dx * (std::log(y[i]) - mean_y);
  }
  if (xx == 0) throw std::invalid_argument("fit_power_law: all x are the same");
  const double slope = xy / xx;
  double residuals = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double residual = std::log(y[i]) - mean_y - slope * (std::log(x[i]) - mean_x);
    residuals += residual * residual;
  }
  const boost::math::students_t_distribution<double> student(count - 2);
  const double margin = boost::math::quantile(student, 0.975) * std::sqrt(residuals / (count - 2) / xx);
  return {std::exp(mean_y - slope * mean_x), slope, slope - margin, slope + margin};
}

}  // namespace sweepgrid::study
