#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <boost/multiprecision/cpp_int.hpp>

#include "accuracy/exact_tests.hpp"

namespace sweepgrid::accuracy {
namespace {

using Rational = boost::multiprecision::cpp_rational;

template <class Number>
using Vector = std::array<Number, 3>;

// The sum of all rounding errors of the tests below, relative to the sum of the magnitudes of all terms, is less than
// 20 * 2^-53 for finite numbers that neither overflow nor lose digits to underflow.
constexpr double kErrorBound = 0x1p-48;
constexpr double kLeastMagnitude = 1e-280;

// Whether `value`, computed from terms of `magnitude` in all, has the sign of what it stands for.
bool sure(double value, double magnitude) {
  return magnitude < std::numeric_limits<double>::infinity() && magnitude > kLeastMagnitude &&
         std::abs(value) > kErrorBound * magnitude;
}

/// Twice the distance of the centres on each axis, and the two diameters.
template <class Number>
struct SpherePair {
  Vector<Number> distance;
  Vector<Number> magnitude;  // of the terms of distance
  Number diameters;
};

template <class Number>
SpherePair<Number> sphere_pair(const SceneBox& a, const SceneBox& b, std::size_t dim) {
  using std::abs;
  SpherePair<Number> pair{};
  std::array<Number, 2> diameters;
  const std::array<const SceneBox*, 2> boxes = {&a, &b};
  for (std::size_t i = 0; i < 2; ++i) {
    diameters[i] = Number(boxes[i]->max[0]) - Number(boxes[i]->min[0]);
    for (std::size_t axis = 1; axis < dim; ++axis) {
      const Number edge = Number(boxes[i]->max[axis]) - Number(boxes[i]->min[axis]);
      if (edge < diameters[i]) diameters[i] = edge;
    }
  }
  pair.diameters = diameters[0] + diameters[1];
  for (std::size_t axis = 0; axis < dim; ++axis) {
    // Differences first: they are small wherever the spheres are.
    const Number low = Number(a.min[axis]) - Number(b.min[axis]);
    const Number high = Number(a.max[axis]) - Number(b.max[axis]);
    pair.distance[axis] = low + high;
    pair.magnitude[axis] = abs(low) + abs(high);
  }
  return pair;
}

/// How far the shadows of two boxes on an axis are apart (negative: they overlap), up to a factor, and the magnitude of
/// its terms.
template <class Number>
struct Gap {
  Number value;
  Number magnitude;
};

/// Two boxes, seen from the centre of the first.
template <class Number>
struct BoxPair {
  Vector<Number> distance;
  std::array<Vector<Number>, 6> edges;  // half edges of the first, then of the second

  BoxPair(const OrientedBox& a, const OrientedBox& b) {
    for (std::size_t i = 0; i < 3; ++i) {
      distance[i] = Number(b.centre[i]) - Number(a.centre[i]);
      for (std::size_t edge = 0; edge < 3; ++edge) {
        edges[edge][i] = Number(a.half_edges[edge][i]);
        edges[3 + edge][i] = Number(b.half_edges[edge][i]);
      }
    }
  }

  /// On the axis that stands square on two of the edges.
  [[nodiscard]] Gap<Number> gap(std::size_t first, std::size_t second) const {
    using std::abs;
    const Vector<Number>& u = edges[first];
    const Vector<Number>& v = edges[second];
    Vector<Number> axis;
    Vector<Number> axis_magnitude;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      const std::size_t k = (i + 2) % 3;
      axis[i] = u[j] * v[k] - u[k] * v[j];
      axis_magnitude[i] = abs(Number(u[j] * v[k])) + abs(Number(u[k] * v[j]));
    }
    const auto along = [&](const Vector<Number>& vector) {
      Gap<Number> sum{0, 0};
      for (std::size_t i = 0; i < 3; ++i) {
        sum.value += axis[i] * vector[i];
        sum.magnitude += axis_magnitude[i] * abs(vector[i]);
      }
      return sum;
    };
    Gap<Number> gap = along(distance);
    gap.value = abs(gap.value);
    for (const Vector<Number>& edge : edges) {
      const Gap<Number> reach = along(edge);
      gap.value -= abs(reach.value);
      gap.magnitude += reach.magnitude;
    }
    return gap;
  }
};

// The axes that may part two boxes: square on two edges of one, or on an edge of each.
template <class Test>
bool for_some_axis(Test&& parts) {
  for (std::size_t first = 0; first < 6; ++first) {
    for (std::size_t second = first + 1; second < 6; ++second) {
      if (parts(first, second)) return true;
    }
  }
  return false;
}

}  // namespace

bool spheres_touch(const SceneBox& a, const SceneBox& b, int dim) {
  const auto axes = static_cast<std::size_t>(dim);
  const auto rounded = sphere_pair<double>(a, b, axes);
  double value = -rounded.diameters * rounded.diameters;
  double magnitude = rounded.diameters * rounded.diameters;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    value += rounded.distance[axis] * rounded.distance[axis];
    magnitude += rounded.magnitude[axis] * rounded.magnitude[axis];
  }
  if (sure(value, magnitude)) return value < 0;
  const auto exact = sphere_pair<Rational>(a, b, axes);
  Rational exact_value = -exact.diameters * exact.diameters;
  for (std::size_t axis = 0; axis < axes; ++axis) exact_value += exact.distance[axis] * exact.distance[axis];
  return exact_value <= 0;
}

bool oriented_boxes_touch(const OrientedBox& a, const OrientedBox& b) {
  const BoxPair<double> rounded(a, b);
  bool all_sure = true;
  const bool apart = for_some_axis([&](std::size_t first, std::size_t second) {
    if (rounded.edges[first] == rounded.edges[second]) return false;  // nothing is square on one edge alone
    const Gap<double> gap = rounded.gap(first, second);
    const bool is_sure = sure(gap.value, gap.magnitude);
    all_sure &= is_sure;
    return is_sure && gap.value > 0;
  });
  if (apart) return false;
  if (all_sure) return true;
  const BoxPair<Rational> exact(a, b);
  return !for_some_axis([&](std::size_t first, std::size_t second) { return exact.gap(first, second).value > 0; });
}

}  // namespace sweepgrid::accuracy
