#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <sweepgrid/sap/box.hpp>

namespace sweepgrid {

/// Doubles hold what the files hold: float32 exactly, text to its last digit. In a scene of two dimensions z is [0, 0].
using SceneBox = Box<double, 3>;

/// The points centre + a e0 + b e1 + c e2 with a, b, c in [-1, 1], the numbers taken as they are: a closed
/// parallelepiped, whose half edges need not be square to the last bit. A shape of two dimensions has e2 = (0, 0, 1).
struct OrientedBox {
  std::array<double, 3> centre{};
  std::array<std::array<double, 3>, 3> half_edges{};

  /// The least box around it, rounded outward: it contains the shape whatever the rounding.
  [[nodiscard]] SceneBox bounds() const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    SceneBox box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double reach = 0;
      for (const auto& edge : half_edges) reach += std::abs(edge[axis]);
      reach *= 1 + 0x1p-50;  // more than the sum may have lost
      box.min[axis] = std::nextafter(centre[axis] - reach, -kInfinity);
      box.max[axis] = std::nextafter(centre[axis] + reach, kInfinity);
    }
    return box;
  }
};

}  // namespace sweepgrid
