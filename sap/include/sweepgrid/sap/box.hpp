#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <limits>
#include <type_traits>

namespace sweepgrid {

/// Anything with `min()` and `max()` that can be indexed by axis, such as Eigen::AlignedBox<Scalar, Dim>.
template <class T, class Scalar>
concept BoxLike = requires(const T& box) {
  { box.min()[0] } -> std::convertible_to<Scalar>;
  { box.max()[0] } -> std::convertible_to<Scalar>;
};

/// A closed axis-aligned bounding box in world units: boxes that only touch overlap. Infinite extents are allowed.
template <class Scalar, int Dim>
struct Box {
  static_assert(Dim >= 1);
  using Point = std::array<Scalar, static_cast<std::size_t>(Dim)>;

  Point min;
  Point max;

  Box() = default;
  Box(const Point& lower, const Point& upper) : min(lower), max(upper) {}

  /// Copies the corners, so that no alignment of the other library crosses into this one.
  template <BoxLike<Scalar> Other>
  Box(const Other& other) {  // NOLINT(google-explicit-constructor): a box is a box
    for (int axis = 0; axis < Dim; ++axis) {
      min[axis] = other.min()[axis];
      max[axis] = other.max()[axis];
    }
  }

  /// No coordinate is NaN, and min <= max on every axis.
  [[nodiscard]] bool valid() const {
    for (int axis = 0; axis < Dim; ++axis) {
      // Written so that a NaN on either side fails.
      if (!(min[axis] <= max[axis])) return false;
    }
    return true;
  }

  [[nodiscard]] bool overlaps(const Box& other) const {
    for (int axis = 0; axis < Dim; ++axis) {
      if (min[axis] > other.max[axis] || other.min[axis] > max[axis]) return false;
    }
    return true;
  }

  friend bool operator==(const Box&, const Box&) = default;
};

}  // namespace sweepgrid
