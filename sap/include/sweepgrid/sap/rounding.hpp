#pragma once

#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <sweepgrid/sap/box.hpp>

// Conversions of coordinates that never take anything from a box. All by bits where a number may be denormal, so they
// hold as well where the host flushes denormals to zero, or reads them as zero. They want rounding to nearest.
namespace sweepgrid {

namespace rounding {

template <class Real>
using BitsOf = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;

template <std::floating_point Real>
inline constexpr BitsOf<Real> kSign = BitsOf<Real>{1} << (8 * sizeof(Real) - 1);

/// |value| as bits: in the order of the values.
template <std::floating_point Real>
[[nodiscard]] BitsOf<Real> magnitude(Real value) {
  return std::bit_cast<BitsOf<Real>>(value) & ~kSign<Real>;
}

template <std::floating_point Real>
[[nodiscard]] bool negative(Real value) {
  return (std::bit_cast<BitsOf<Real>>(value) & kSign<Real>) != 0;
}

/// Zero or denormal.
template <std::floating_point Real>
[[nodiscard]] bool tiny(Real value) {
  return magnitude(value) < magnitude(std::numeric_limits<Real>::min());
}

}  // namespace rounding

/// The next value above; infinity has none and is returned. Precondition: not NaN.
template <std::floating_point Real>
[[nodiscard]] Real next_above(Real value) {
  using Bits = rounding::BitsOf<Real>;
  const Bits bits = std::bit_cast<Bits>(value);
  if (rounding::magnitude(value) == 0) return std::numeric_limits<Real>::denorm_min();
  if (rounding::negative(value)) return std::bit_cast<Real>(bits - 1);
  return std::bit_cast<Real>(bits + (std::isinf(value) ? 0 : 1));
}

template <std::floating_point Real>
[[nodiscard]] Real next_below(Real value) {
  return -next_above(-value);
}

/// The greatest float that is not above `value`; NaN stays NaN.
[[nodiscard]] inline float round_below(double value) {
  if (rounding::magnitude(value) < rounding::magnitude(double{std::numeric_limits<float>::min()})) {
    // Denormal as a float: counted in its smallest steps.
    double steps = std::floor(value * 0x1p149);
    if (rounding::tiny(value)) steps = rounding::negative(value) && rounding::magnitude(value) != 0 ? -1 : 0;
    const auto bits = static_cast<std::uint32_t>(std::fabs(steps));
    return std::bit_cast<float>(steps < 0 ? bits | rounding::kSign<float> : bits);
  }
  const auto nearest = static_cast<float>(value);
  return static_cast<double>(nearest) > value ? next_below(nearest) : nearest;
}

/// The least float that is not below `value`; NaN stays NaN.
[[nodiscard]] inline float round_above(double value) { return -round_below(-value); }

/// The least box of floats that holds `box`. Two boxes that overlap do so afterwards: a set of pairs found with float
/// boxes is a superset, at any distance from the origin. What is not valid does not become so: the engine refuses it.
template <std::same_as<float> To, int Dim>
[[nodiscard]] Box<To, Dim> round_outward(const Box<double, Dim>& box) {
  Box<To, Dim> result;
  for (int axis = 0; axis < Dim; ++axis) {
    const bool valid = box.min[axis] <= box.max[axis];
    result.min[axis] = valid ? round_below(box.min[axis]) : round_above(box.min[axis]);
    result.max[axis] = valid ? round_above(box.max[axis]) : round_below(box.max[axis]);
  }
  return result;
}

/// A value not below `value` + `by`: for integers the least one, or the last of the type where there is none; for
/// floating point at most some neighbours higher; `value` itself where `by` is 0. Precondition: 0 <= `by` < infinity.
template <class Scalar>
[[nodiscard]] Scalar sum_above(Scalar value, double by) {
  if (rounding::magnitude(by) == 0) return value;
  if constexpr (std::floating_point<Scalar>) {
    constexpr Scalar kLeast = std::numeric_limits<Scalar>::min();
    if (std::isinf(value)) return value;
    if (rounding::tiny(value)) value = rounding::negative(value) ? 0 : kLeast;
    if (rounding::tiny(by)) by = std::numeric_limits<double>::min();
    const double sum = static_cast<double>(value) + by;
    if (rounding::tiny(sum)) return kLeast;
    if constexpr (std::same_as<Scalar, float>) {
      return round_above(next_above(sum));
    } else {
      return next_above(sum);
    }
  } else {
    constexpr Scalar kLast = std::numeric_limits<Scalar>::max();
    const double steps = std::ceil(by);
    if (!(steps < 0x1p64)) return kLast;
    Scalar sum;
    return __builtin_add_overflow(value, static_cast<std::uint64_t>(steps), &sum) ? kLast : sum;
  }
}

/// Likewise a value not above `value` - `by`.
template <class Scalar>
[[nodiscard]] Scalar sum_below(Scalar value, double by) {
  if constexpr (std::floating_point<Scalar>) {
    return rounding::magnitude(by) == 0 ? value : -sum_above(-value, by);
  } else {
    constexpr Scalar kFirst = std::numeric_limits<Scalar>::min();
    const double steps = std::ceil(by);
    if (!(steps < 0x1p64)) return kFirst;
    Scalar sum;
    return __builtin_sub_overflow(value, static_cast<std::uint64_t>(steps), &sum) ? kFirst : sum;
  }
}

}  // namespace sweepgrid
