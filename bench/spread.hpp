#pragma once

#include <algorithm>
#include <vector>

namespace sweepgrid::bench {

/// A figure over several rounds.
struct Spread {
  double median = 0;
  double low = 0;
  double high = 0;
};

/// Of a sample; all 0 for none.
[[nodiscard]] inline Spread spread(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return {values[values.size() / 2], values.front(), values.back()};
}

}  // namespace sweepgrid::bench
