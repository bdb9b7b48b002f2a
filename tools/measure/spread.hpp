#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace sweepgrid {

/// Several samples of one figure.
struct Spread {
  double median = 0;
  double low = 0;
  double high = 0;
};

/// All 0 for no samples. The median of an even number is the mean of the middle two.
[[nodiscard]] inline Spread spread(std::vector<double> samples) {
  if (samples.empty()) return {};
  std::sort(samples.begin(), samples.end());
  const std::size_t half = samples.size() / 2;
  const double median = samples.size() % 2 == 1 ? samples[half] : (samples[half - 1] + samples[half]) / 2;
  return {median, samples.front(), samples.back()};
}

}  // namespace sweepgrid
