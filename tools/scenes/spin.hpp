#pragma once

#include <array>
#include <cstddef>

#include "scenes/oriented_box.hpp"
#include "scenes/random_stream.hpp"

namespace sweepgrid {

/// How an object that is an oriented box is turned, and the axis about which it turns. Of floating point only + - * /
/// and sqrt, as everything in the generated scenes.
class Spin {
 public:
  /// At random; in two dimensions about z.
  Spin(RandomStream& random, std::size_t dim);

  /// About `radians` on: twice the arc tangent of half of it.
  void turn(double radians);

  /// Edges in the ratio 6 : 3 : 2 (in two dimensions 4 : 3), its diagonal is `width`: the box around it never exceeds a
  /// cube of that width.
  [[nodiscard]] OrientedBox shape(const std::array<double, 3>& centre, double width) const;

 private:
  std::size_t dim_;
  std::array<double, 4> orientation_;  // unit quaternion, the real part first
  std::array<double, 3> axis_;         // of length 1
};

}  // namespace sweepgrid
