#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <sweepgrid/sap/box.hpp>

namespace sweepgrid {

/// The unsigned integer that holds a Scalar's value in order-preserving form: 32 bits where they suffice, else 64.
template <class Scalar>
using OrderedBits = std::conditional_t<sizeof(Scalar) <= 4, std::uint32_t, std::uint64_t>;

/// Maps a scalar to an unsigned integer so that a < b exactly when ordered_bits(a) < ordered_bits(b); -0.0 and 0.0 map
/// alike. The whole of sweep and prune then runs on integers: no rounding, no NaN, and denormals stay apart even
/// where the host flushes them to zero. Precondition: not NaN.
template <class Scalar>
[[nodiscard]] OrderedBits<Scalar> ordered_bits(Scalar value) {
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

/// A box whose coordinates are ordered bits. Closed, like Box.
template <class Scalar, int Dim>
struct OrderedBox {
  using Bits = OrderedBits<Scalar>;

  std::array<Bits, static_cast<std::size_t>(Dim)> min;
  std::array<Bits, static_cast<std::size_t>(Dim)> max;

  OrderedBox() = default;
  [[gnu::always_inline]] explicit OrderedBox(const Box<Scalar, Dim>& box) {
    // Side by side, so that vectors hold them.
    std::array<Scalar, 2 * static_cast<std::size_t>(Dim)> from;
    std::array<Bits, 2 * static_cast<std::size_t>(Dim)> to;
    for (int axis = 0; axis < Dim; ++axis) from[axis] = box.min[axis], from[Dim + axis] = box.max[axis];
    for (int i = 0; i < 2 * Dim; ++i) to[i] = ordered_bits(from[i]);
    for (int axis = 0; axis < Dim; ++axis) min[axis] = to[axis], max[axis] = to[Dim + axis];
  }

  /// Overlap on every axis but `skipped`; pass -1 to skip none.
  [[nodiscard]] bool overlaps_beside(int skipped, const OrderedBox& other) const {
    // Bitwise on purpose: the outcome is unpredictable, and a branch per axis costs more than the comparisons.
    unsigned overlap = 1;
    for (int axis = 0; axis < Dim; ++axis) {
      const auto meets = unsigned{min[axis] <= other.max[axis]} & unsigned{other.min[axis] <= max[axis]};
      overlap &= meets | unsigned{axis == skipped};
    }
    return overlap != 0;
  }

  /// Without a lower or an upper end, or both, on one axis.
  [[nodiscard]] OrderedBox opened(int axis, bool lower, bool upper) const {
    OrderedBox open;
    for (int d = 0; d < Dim; ++d) {
      open.min[d] = d == axis && lower ? Bits{0} : min[d];
      open.max[d] = d == axis && upper ? static_cast<Bits>(~Bits{0}) : max[d];
    }
    return open;
  }

  [[nodiscard]] bool overlaps(const OrderedBox& other) const { return overlaps_beside(-1, other); }

  friend bool operator==(const OrderedBox&, const OrderedBox&) = default;
};

}  // namespace sweepgrid
