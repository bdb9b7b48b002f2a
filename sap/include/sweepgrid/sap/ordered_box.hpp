#pragma once

#include <array>
#include <cstddef>

#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/sap/ordered_bits.hpp>

namespace sweepgrid {

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
