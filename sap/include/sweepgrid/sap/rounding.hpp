#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/sap/float_bits.hpp>

// Conversions of coordinates that never take anything from a box. All by bits where a number may be denormal, infinite
// or NaN, so they hold as well where the host flushes denormals to zero or reads them as zero, and in files that are
// compiled with -ffast-math. Only sums round as the thread does: at most some neighbours higher or lower.
namespace sweepgrid {

/// The next value above; infinity has none and is returned. Precondition: not NaN.
template <std::floating_point Real>
[[nodiscard]] Real next_above(Real value) {
  using Bits = rounding::BitsOf<Real>;
  const Bits bits = std::bit_cast<Bits>(value);
  if (rounding::magnitude(value) == 0) return std::numeric_limits<Real>::denorm_min();
  if (rounding::negative(value)) return std::bit_cast<Real>(bits - 1);
  return std::bit_cast<Real>(bits + (rounding::infinite(value) ? 0 : 1));
}

template <std::floating_point Real>
[[nodiscard]] Real next_below(Real value) {
  return -next_above(-value);
}

namespace rounding {

constexpr int kCutBits = 52 - 23;              ///< of a double's fraction are not in a float's
constexpr std::uint64_t kRebias = 1023 - 127;  ///< between the exponents of a double and a float of equal value
constexpr std::uint32_t kFloatInfinity = 0x7f800000;

/// The nearest float at or above `value`, or else at or below it. NaN stays NaN.
[[nodiscard]] inline float float_beside(double value, bool above) {
  constexpr std::uint64_t kUnit = std::uint64_t{1} << 52;
  const std::uint64_t whole = magnitude(value);
  std::uint64_t kept;  // the float towards zero
  bool lost = false;   // whether it is another value
  if (whole > magnitude(std::numeric_limits<double>::infinity())) {
    kept = kFloatInfinity | 1U << 22 | (whole >> kCutBits & 0x3fffff);
  } else if (whole > magnitude(double{std::numeric_limits<float>::max()})) {
    lost = !infinite(value);
    kept = kFloatInfinity - (lost ? 1 : 0);
  } else {
    std::uint64_t exponent = whole / kUnit;
    std::uint64_t fraction = whole;
    std::uint64_t cut = kCutBits;
    if (exponent <= kRebias) {  // denormal as a float: its unit becomes one more bit of the fraction
      fraction = whole % kUnit | (exponent != 0 ? kUnit : 0);
      cut += kRebias + 1 - exponent;
      if (cut > 63) cut = 63;
      exponent = kRebias;
    } else {
      fraction -= kRebias * kUnit;
    }
    kept = fraction >> cut;
    lost = fraction != kept << cut;
  }
  if (lost && above != negative(value)) ++kept;  // which is the next float away from zero
  const bool minus = kept == 0 ? above : negative(value);
  return std::bit_cast<float>(static_cast<std::uint32_t>(kept) | (minus ? kSign<float> : 0));
}

}  // namespace rounding

/// The greatest float that is not above `value`; NaN stays NaN.
[[nodiscard]] inline float round_below(double value) { return rounding::float_beside(value, false); }

/// The least float that is not below `value`; NaN stays NaN.
[[nodiscard]] inline float round_above(double value) { return rounding::float_beside(value, true); }

namespace rounding {

/// Four ends of a box at once: without a branch, and by integers alone.
class FourEnds {
 public:
  using Words = std::uint32_t __attribute__((vector_size(16)));

  /// Reads four doubles at `from`. `up`: the sign bit for those that are to be rounded up, 0 for the others.
  FourEnds(const double* from, Words up) : up_(up) {
    Words first;
    Words second;
    std::memcpy(&first, from, sizeof(first));
    std::memcpy(&second, from + 2, sizeof(second));
    low_ = __builtin_shufflevector(first, second, 0, 2, 4, 6);
    high_ = __builtin_shufflevector(first, second, 1, 3, 5, 7);
  }

  /// All ones where floats() is right: the value is zero or in the range of normal floats.
  [[nodiscard]] Words common() const {
    constexpr std::uint32_t kLeast = (kRebias + 1) << 20;
    constexpr std::uint32_t kEnd = (kRebias + 255) << 20;
    return reinterpret_cast<Words>((high_ & ~kMinus) - kLeast < kEnd - kLeast) | zero();
  }

  /// The bits of the floats.
  [[nodiscard]] Words floats() const {
    const Words minus = high_ & kMinus;
    const Words kept = ((high_ ^ minus) << 3 | low_ >> kCutBits) - (static_cast<std::uint32_t>(kRebias) << 23);
    const Words lost = reinterpret_cast<Words>((low_ & ((1U << kCutBits) - 1)) != 0U);
    const Words away = (high_ ^ up_) >> 31;
    const Words rounded = (kept + (lost & away)) | minus;
    return (rounded & ~zero()) | (up_ & zero());
  }

 private:
  static constexpr std::uint32_t kMinus = 0x80000000;
  [[nodiscard]] Words zero() const { return reinterpret_cast<Words>(((high_ & ~kMinus) | low_) == 0U); }

  Words low_, high_, up_;
};

/// Rounds the four ends from kNext on outward, or those of them that a box of Dim axes has; Dim: 2 or more. Returns
/// FourEnds::common().
template <int Dim, int kNext>
FourEnds::Words round_four(const double* from, float* to) {
  constexpr int kFirst = std::min(kNext, 2 * Dim - 4);  // reads some again rather than beyond the end
  const auto up = [](int end) { return end < Dim ? 0 : kSign<float>; };
  const FourEnds::Words ups = {up(kFirst), up(kFirst + 1), up(kFirst + 2), up(kFirst + 3)};
  const FourEnds ends(from + kFirst, ups);
  const FourEnds::Words floats = ends.floats();
  // Writes none again: what is read soon after should come from one write.
  constexpr int kOld = kNext - kFirst;
  std::memcpy(to + kNext, reinterpret_cast<const float*>(&floats) + kOld, (4 - kOld) * sizeof(float));
  return ends.common();
}

/// Rounds all ends of a box outward; returns whether all were common.
template <int Dim, int... kFours>
bool round_ends(const double* from, float* to, std::integer_sequence<int, kFours...>) {
  const FourEnds::Words common = (round_four<Dim, 4 * kFours>(from, to) & ...);
  return (common[0] & common[1] & common[2] & common[3]) != 0;
}

}  // namespace rounding

/// The least box of floats that holds `box`. Two boxes that overlap do so afterwards: a set of pairs found with float
/// boxes is a superset, at any distance from the origin. What is not valid does not become so: the engine refuses it.
template <std::same_as<float> To, int Dim>
[[nodiscard]] Box<To, Dim> round_outward(const Box<double, Dim>& box) {
  Box<To, Dim> result;
  if constexpr (Dim > 1) {
    static_assert(sizeof(box) == 2 * Dim * sizeof(double) && sizeof(result) == 2 * Dim * sizeof(float));
    const bool common = rounding::round_ends<Dim>(box.min.data(), result.min.data(),
                                                  std::make_integer_sequence<int, (2 * Dim + 3) / 4>());
    // Common numbers are compared rightly everywhere: none is NaN or denormal.
    bool ordered = true;
    for (int axis = 0; axis < Dim; ++axis) ordered &= box.min[axis] <= box.max[axis];
    if (common && ordered) [[likely]]
      return result;
  }
  for (int axis = 0; axis < Dim; ++axis) {
    const bool valid = in_order(box.min[axis], box.max[axis]);
    result.min[axis] = rounding::float_beside(box.min[axis], !valid);
    result.max[axis] = rounding::float_beside(box.max[axis], valid);
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
    if (rounding::infinite(value)) return value;
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
    const double steps = rounding::tiny(by) ? 1 : std::ceil(by);
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
    if (rounding::magnitude(by) == 0) return value;
    constexpr Scalar kFirst = std::numeric_limits<Scalar>::min();
    const double steps = rounding::tiny(by) ? 1 : std::ceil(by);
    if (!(steps < 0x1p64)) return kFirst;
    Scalar sum;
    return __builtin_sub_overflow(value, static_cast<std::uint64_t>(steps), &sum) ? kFirst : sum;
  }
}

}  // namespace sweepgrid
