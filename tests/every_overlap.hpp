#pragma once

#include <cstddef>
#include <vector>

#include <sweepgrid/sap/float_bits.hpp>

namespace sweepgrid::oracle {

/// Calls found(a, b) for all boxes that overlap, a < b, in this order: compares every box with every other. Along the
/// first axis these are plain numbers in a row, for most pairs are told apart there, and under the sanitizers tests are
/// not optimised.
template <class BoxType, class Found>
void every_overlap(const std::vector<BoxType>& boxes, const Found& found) {
  using Steps = decltype(rounding::steps_from_zero(boxes[0].min[0]));
  std::vector<Steps> low;
  std::vector<Steps> high;
  for (const BoxType& box : boxes) {
    low.push_back(rounding::steps_from_zero(box.min[0]));
    high.push_back(rounding::steps_from_zero(box.max[0]));
  }
  const Steps* const lows = low.data();
  const Steps* const highs = high.data();
  const std::size_t count = boxes.size();
  for (std::size_t a = 0; a < count; ++a) {
    const Steps from = lows[a];
    const Steps to = highs[a];
    for (std::size_t b = a + 1; b < count; ++b) {
      if (lows[b] <= to && from <= highs[b] && boxes[a].overlaps(boxes[b])) found(a, b);
    }
  }
}

}  // namespace sweepgrid::oracle
