#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace sweepgrid::baselines {

/// A box as a narrow phase has it: where it is, how it is turned (columns are its axes) and half its edges.
struct PlacedBox {
  std::array<float, 3> centre{};
  std::array<std::array<float, 3>, 3> axes{};
  std::array<float, 3> half{};
};

using PlacedPairs = std::vector<std::pair<PlacedBox, PlacedBox>>;

/// Gives every pair to a library's test of two boxes, contact points included, as a narrow phase does. Returns how many
/// touch. Each is there with SWEEPGRID_WITH_BULLET or SWEEPGRID_WITH_FCL only.
[[nodiscard]] std::size_t bullet_touching(const PlacedPairs& pairs);
[[nodiscard]] std::size_t fcl_touching(const PlacedPairs& pairs);

}  // namespace sweepgrid::baselines
