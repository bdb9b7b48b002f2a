#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>

// Numbers compared by their bits. A comparison of floating-point numbers means something else where the compiler takes
// it that there is no NaN (-ffast-math), and where the thread reads denormals as zero; this does not.
namespace sweepgrid {

/// The unsigned integer that holds a Scalar's value in order-preserving form: 32 bits where they suffice, else 64.
template <class Scalar>
using OrderedBits = std::conditional_t<sizeof(Scalar) <= 4, std::uint32_t, std::uint64_t>;

/// Maps a scalar to an unsigned integer so that a < b exactly when ordered_bits(a) < ordered_bits(b); -0.0 and 0.0 map
/// alike. The whole of sweep and prune then runs on integers: no rounding, no NaN, and denormals stay apart even
/// where the host flushes them to zero. A NaN lies beyond the infinity of its sign.
template <class Scalar>
[[nodiscard]] constexpr OrderedBits<Scalar> ordered_bits(Scalar value) {
  using Bits = OrderedBits<Scalar>;
  constexpr Bits kSign = Bits{1} << (8 * sizeof(Bits) - 1);
  if constexpr (std::floating_point<Scalar>) {
    static_assert(std::numeric_limits<Scalar>::is_iec559 && sizeof(Scalar) == sizeof(Bits));
    // Without branches, so that a whole box is converted at once.
    Bits bits = std::bit_cast<Bits>(value);
    bits = bits == kSign ? 0 : bits;  // -0.0
    const Bits negative = Bits{0} - (bits >> (8 * sizeof(Bits) - 1));
    return bits ^ (negative | kSign);
  } else if constexpr (std::signed_integral<Scalar>) {
    return static_cast<Bits>(static_cast<std::make_signed_t<Bits>>(value)) ^ kSign;
  } else {
    static_assert(std::unsigned_integral<Scalar>);
    return value;
  }
}

/// a <= b, and neither is NaN.
template <class Scalar>
[[nodiscard]] constexpr bool in_order(Scalar a, Scalar b) {
  if constexpr (std::floating_point<Scalar>) {
    constexpr auto kInfinity = ordered_bits(std::numeric_limits<Scalar>::infinity());
    constexpr auto kMinusInfinity = ordered_bits(-std::numeric_limits<Scalar>::infinity());
    const auto low = ordered_bits(a);
    const auto high = ordered_bits(b);
    return kMinusInfinity <= low && low <= high && high <= kInfinity;
  } else {
    return a <= b;
  }
}

}  // namespace sweepgrid
