#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "baselines/peer_narrow_phase.hpp"

namespace sweepgrid::accuracy {

/// What a narrow phase costs for a candidate pair, whether or not it touches.
struct NarrowPhasePrice {
  double ns = 0;
  double low_ns = 0;  ///< least and most of the repetitions
  double high_ns = 0;
  std::string source;  ///< whose test, and where it was measured
};

/// Candidates as a broad phase hands them on: oriented boxes, edges 6 : 3 : 2, whose bounding boxes overlap. 3D.
[[nodiscard]] baselines::PlacedPairs narrow_phase_candidates();

/// "bullet" or "fcl", as far as they were there when this was built.
[[nodiscard]] std::vector<std::string> narrow_phases();

/// Processor time of the library's box-box test here and now, the median of several repetitions. Throws
/// std::invalid_argument when there is no narrow phase of that name.
[[nodiscard]] NarrowPhasePrice measure_narrow_phase(std::string_view name);

/// Measured with Bullet's test; or with FCL's; or, without both, what was once measured on the machine that is named.
[[nodiscard]] NarrowPhasePrice default_narrow_phase_price();

}  // namespace sweepgrid::accuracy
