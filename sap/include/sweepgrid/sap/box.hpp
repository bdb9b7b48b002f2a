#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <limits>
#include <type_traits>

#include <sweepgrid/sap/float_bits.hpp>

namespace sweepgrid {

/// Whether every value of From is one of To. A type that is no number of the language's own decides by its conversions.
template <class From, class To>
inline constexpr bool kHoldsEvery = [] {
  using F = std::numeric_limits<From>;
  using T = std::numeric_limits<To>;
  if constexpr (!std::is_arithmetic_v<From> || std::same_as<From, To>) {
    return true;
  } else if constexpr (std::floating_point<From>) {
    return std::floating_point<To> && F::digits <= T::digits && F::max_exponent <= T::max_exponent;
  } else {
    return F::digits <= T::digits && (std::floating_point<To> || T::is_signed || !F::is_signed);
  }
}();

/// Anything with `min()` and `max()` that can be indexed by axis, such as Eigen::AlignedBox<Scalar, Dim>. A box of a
/// scalar whose values do not all fit is none: how they are to be rounded is for the client to say, with
/// round_outward() or a Quantizer.
template <class T, class Scalar>
concept BoxLike = requires(const T& box) {
  { box.min()[0] } -> std::convertible_to<Scalar>;
  { box.max()[0] } -> std::convertible_to<Scalar>;
  requires kHoldsEvery<std::remove_cvref_t<decltype(box.min()[0])>, Scalar>;
  requires kHoldsEvery<std::remove_cvref_t<decltype(box.max()[0])>, Scalar>;
};

/// a <= b, and neither is NaN. By bits.
template <class Scalar>
[[nodiscard, gnu::always_inline]] constexpr bool in_order(Scalar a, Scalar b) {
  const auto low = rounding::steps_from_zero(a);
  const auto high = rounding::steps_from_zero(b);
  if constexpr (std::floating_point<Scalar>) {
    constexpr auto kInfinity = rounding::steps_from_zero(std::numeric_limits<Scalar>::infinity());
    return -kInfinity <= low && low <= high && high <= kInfinity;
  } else {
    return low <= high;
  }
}

/// A closed axis-aligned bounding box in world units: boxes that only touch overlap. Infinite extents are allowed.
/// Boxes are compared by bits, so that neither a compiler's flags nor the thread's floating-point mode matter.
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

  /// No coordinate is NaN, and min <= max on every axis. Inline always: else the linker may have the library, which
  /// asks for every update, use a client's copy that is not optimised.
  [[nodiscard, gnu::always_inline]] bool valid() const {
#if !__FINITE_MATH_ONLY__
    // All that boxes of positive extent need, and much faster than bits: a NaN is in no order, and what is in strict
    // order where denormals are read as zero is so where they are not.
    bool strict = true;
    for (int axis = 0; axis < Dim; ++axis) strict = strict && min[axis] < max[axis];
    if (strict) return true;
#endif
    for (int axis = 0; axis < Dim; ++axis) {
      if (!in_order(min[axis], max[axis])) return false;
    }
    return true;
  }

  /// Precondition: both are valid.
  [[nodiscard]] bool overlaps(const Box& other) const {
    using rounding::steps_from_zero;
    for (int axis = 0; axis < Dim; ++axis) {
      if (steps_from_zero(min[axis]) > steps_from_zero(other.max[axis])) return false;
      if (steps_from_zero(other.min[axis]) > steps_from_zero(max[axis])) return false;
    }
    return true;
  }

  /// -0.0 and 0.0 are equal; a NaN is equal to one of the same bits.
  friend bool operator==(const Box& a, const Box& b) {
    using rounding::steps_from_zero;
    for (int axis = 0; axis < Dim; ++axis) {
      if (steps_from_zero(a.min[axis]) != steps_from_zero(b.min[axis])) return false;
      if (steps_from_zero(a.max[axis]) != steps_from_zero(b.max[axis])) return false;
    }
    return true;
  }
};

}  // namespace sweepgrid
