#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <sweepgrid/sap/platform.hpp>

// What kind of number one is, by its bits: also where the compiler takes it that all are finite, or where the thread
// reads denormals as zero.
namespace sweepgrid::rounding {

template <class Real>
using BitsOf = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;

template <std::floating_point Real>
inline constexpr BitsOf<Real> kSign = BitsOf<Real>{1} << (8 * sizeof(Real) - 1);

/// |value| as bits: in the order of the values.
template <std::floating_point Real>
[[nodiscard]] constexpr BitsOf<Real> magnitude(Real value) {
  return std::bit_cast<BitsOf<Real>>(value) & ~kSign<Real>;
}

template <std::floating_point Real>
[[nodiscard]] constexpr bool negative(Real value) {
  return (std::bit_cast<BitsOf<Real>>(value) & kSign<Real>) != 0;
}

/// Zero or denormal.
template <std::floating_point Real>
[[nodiscard]] constexpr bool tiny(Real value) {
  return magnitude(value) < magnitude(std::numeric_limits<Real>::min());
}

/// Neither infinite nor NaN.
template <std::floating_point Real>
[[nodiscard]] constexpr bool finite(Real value) {
  return magnitude(value) < magnitude(std::numeric_limits<Real>::infinity());
}

template <std::floating_point Real>
[[nodiscard]] constexpr bool infinite(Real value) {
  return magnitude(value) == magnitude(std::numeric_limits<Real>::infinity());
}

/// How many numbers of the type away from zero, downwards if negative: in the order of the values, and 0 for both
/// zeros. A NaN is beyond the infinity of its sign. Of an integer, itself.
template <class Scalar>
[[nodiscard, gnu::always_inline]] constexpr auto steps_from_zero(Scalar value) {
  if constexpr (std::floating_point<Scalar>) {
    static_assert(std::numeric_limits<Scalar>::is_iec559 && sizeof(Scalar) == sizeof(BitsOf<Scalar>));
    const auto steps = static_cast<std::make_signed_t<BitsOf<Scalar>>>(magnitude(value));
    return negative(value) ? -steps : steps;
  } else {
    return value;
  }
}

}  // namespace sweepgrid::rounding
