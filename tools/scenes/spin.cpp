#include "scenes/spin.hpp"

#include <cmath>

namespace sweepgrid {
namespace {

// A point of the ball, drawn from the cube around it, scaled to length 1. Components outside `first` to `last` are 0.
template <std::size_t Size>
std::array<double, Size> random_unit(RandomStream& random, std::size_t first, std::size_t last) {
  while (true) {
    std::array<double, Size> point{};
    double squared = 0;
    for (std::size_t i = first; i < last; ++i) {
      point[i] = random.between(-1, 1);
      squared += point[i] * point[i];
    }
    if (squared > 1 || squared < 0x1p-20) continue;
    const double length = std::sqrt(squared);
    for (double& component : point) component /= length;
    return point;
  }
}

std::array<double, 4> product(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

}  // namespace

Spin::Spin(RandomStream& random, std::size_t dim) : dim_(dim) {
  orientation_ = random_unit<4>(random, 0, dim == 3 ? 4 : 2);
  if (dim == 2) orientation_ = {orientation_[0], 0, 0, orientation_[1]};
  axis_ = dim == 3 ? random_unit<3>(random, 0, 3) : std::array<double, 3>{0, 0, 1};
}

void Spin::turn(double radians) {
  const double half = radians / 2;
  orientation_ = product({1, half * axis_[0], half * axis_[1], half * axis_[2]}, orientation_);
  double squared = 0;
  for (const double component : orientation_) squared += component * component;
  const double length = std::sqrt(squared);
  for (double& component : orientation_) component /= length;
}

OrientedBox Spin::shape(const std::array<double, 3>& centre, double width) const {
  const auto [w, x, y, z] = orientation_;
  // The columns of the rotation matrix.
  const std::array<std::array<double, 3>, 3> axes = {
      {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
       {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
       {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}}};
  // 6² + 3² + 2² = 7², 4² + 3² = 5².
  const std::array<double, 3> parts = dim_ == 3 ? std::array{6.0 / 14, 3.0 / 14, 2.0 / 14} : std::array{0.4, 0.3, 0.0};
  OrientedBox box;
  box.centre = centre;
  for (std::size_t edge = 0; edge < 3; ++edge) {
    for (std::size_t i = 0; i < 3; ++i) box.half_edges[edge][i] = parts[edge] * width * axes[edge][i];
  }
  if (dim_ == 2) box.half_edges[2] = {0, 0, 1};
  return box;
}

}  // namespace sweepgrid
