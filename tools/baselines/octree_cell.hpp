#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include <sweepgrid/sap/box.hpp>

namespace sweepgrid::baselines {

/// The part of space that a node of an octree answers for, and the three planes that cut it into its children's. A
/// point belongs to the upper side of a plane that it lies on, so every point is in one cell of each level.
template <class Scalar>
struct OctreeCell {
  using Point = std::array<Scalar, 3>;
  using BoxType = Box<Scalar, 3>;
  static constexpr Scalar kInfinity = std::numeric_limits<Scalar>::infinity();

  Point centre{};                                 ///< where the planes are
  Scalar edge = 0;                                ///< its width, as if the root's had an end
  Point low{-kInfinity, -kInfinity, -kInfinity};  ///< low <= p < high; infinite at the root's border
  Point high{kInfinity, kInfinity, kInfinity};

  /// Whether all points of a closed box are in it.
  [[nodiscard]] bool holds(const BoxType& box) const {
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis) {
      inside &= (low[axis] <= box.min[axis]) & ((box.max[axis] < high[axis]) | (high[axis] == kInfinity));
    }
    return inside;
  }

  /// Whether a box reaches beyond its width around the centre, though perhaps not out of the cell.
  [[nodiscard]] bool reached_beyond_by(const BoxType& box) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (box.min[axis] < centre[axis] - edge / 2 || box.max[axis] > centre[axis] + edge / 2) return true;
    }
    return false;
  }

  [[nodiscard]] bool too_wide_for_children(const BoxType& box) const {
    bool wide = false;
    for (int axis = 0; axis < 3; ++axis) wide |= box.max[axis] - box.min[axis] > edge / 2;
    return wide;
  }

  /// The children that a closed box meets, as bits; bit i of a child's number is set on the upper side of axis i.
  [[nodiscard]] unsigned children_met(const BoxType& box) const {
    constexpr unsigned kUpper[] = {0xaa, 0xcc, 0xf0};
    unsigned met = 0xff;
    for (int axis = 0; axis < 3; ++axis) {
      const unsigned lower = box.min[axis] < centre[axis] ? ~kUpper[axis] : 0;
      const unsigned upper = box.max[axis] >= centre[axis] ? kUpper[axis] : 0;
      met &= lower | upper;
    }
    return met;
  }

  [[nodiscard]] OctreeCell child(unsigned number) const {
    OctreeCell cell = *this;
    cell.edge = edge / 2;
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = (number >> axis & 1U) != 0;
      cell.centre[axis] = upper ? centre[axis] + edge / 4 : centre[axis] - edge / 4;
      (upper ? cell.low : cell.high)[axis] = centre[axis];
    }
    return cell;
  }

  /// Whether there are coordinates enough to cut its children as well.
  [[nodiscard]] bool divisible() const {
    bool room = true;
    for (int axis = 0; axis < 3; ++axis) {
      const Scalar c = centre[axis];
      room &= (low[axis] < c - edge / 4) & (c - edge / 4 < c) & (c < c + edge / 4) & (c + edge / 4 < high[axis]);
    }
    return room;
  }
};

}  // namespace sweepgrid::baselines
