#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>

#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/sap/refuse_argument.hpp>
#include <sweepgrid/sap/rounding.hpp>

namespace sweepgrid {

/// Maps boxes in world units to boxes of small integers, for an engine of these: half the memory of double or less, and
/// the same pairs on every machine.
///
/// Guarantee: superset only. Every lower end is rounded down, every upper end up, and the map never decreases: boxes
/// that overlap in the world overlap as integers, wherever they are. What lies beyond the ends of the type is mapped
/// to the ends, and everything there overlaps. Where the type suffices, the box of integers holds the box in the world
/// exactly: steps are powers of two, so nothing else is ever rounded.
///
/// A box with a NaN or min > max becomes one with min > max, which the engine refuses.
template <std::integral Int, int Dim>
class Quantizer {
  static_assert(sizeof(Int) <= 4, "double tells the neighbours of a longer integer no longer apart");

 public:
  using World = Box<double, Dim>;
  using Point = typename World::Point;

  /// `origin` is mapped near 0. `resolution`: the step of one, in world units; made the power of two at or below it.
  /// Throws std::invalid_argument unless both are finite, and `resolution` is positive and normal.
  Quantizer(const Point& origin, double resolution) {
    if (rounding::tiny(resolution) || rounding::negative(resolution) || !rounding::finite(resolution)) {
      refuse_argument("sweepgrid: Quantizer: the resolution must be positive and normal");
    }
    resolution_ = std::ldexp(1.0, std::min(std::ilogb(resolution), 1022));
    for (int axis = 0; axis < Dim; ++axis) {
      if (!rounding::finite(origin[axis])) {
        refuse_argument("sweepgrid: Quantizer: the origin must be finite");
      }
      origin_[axis] = std::clamp(std::floor(origin[axis] / resolution_), -kMost, kMost);
    }
  }

  /// The finest one for which `world` fits into the type. Throws std::invalid_argument unless it is valid and finite.
  [[nodiscard]] static Quantizer covering(const World& world) {
    double half_width = std::numeric_limits<double>::min() * 0x1p64;
    Point origin;
    for (int axis = 0; axis < Dim; ++axis) {
      const double half = world.max[axis] / 2 - world.min[axis] / 2;
      if (!in_order(world.min[axis], world.max[axis]) || !rounding::finite(world.min[axis]) ||
          !rounding::finite(world.max[axis])) {
        refuse_argument("sweepgrid: Quantizer: the world must be a valid and finite box");
      }
      const double farthest = std::max(std::fabs(world.min[axis]), std::fabs(world.max[axis]));
      half_width = std::max(half_width, half + farthest * std::numeric_limits<double>::epsilon());
      origin[axis] = std::is_signed_v<Int> ? world.min[axis] / 2 + world.max[axis] / 2 : world.min[axis];
    }
    // A few steps are kept for the rounding of the ends and of the origin.
    constexpr int kBits = std::numeric_limits<std::make_unsigned_t<Int>>::digits;
    int exponent;
    static_cast<void>(std::frexp(half_width / (std::ldexp(1.0, kBits - 1) - 4), &exponent));
    return Quantizer(origin, std::ldexp(1.0, exponent));
  }

  /// The step of one, in world units.
  [[nodiscard]] double resolution() const { return resolution_; }

  [[nodiscard]] Box<Int, Dim> operator()(const World& box) const {
    Box<Int, Dim> result;
    for (int axis = 0; axis < Dim; ++axis) {
      if (in_order(box.min[axis], box.max[axis])) {
        result.min[axis] = saturated(below(box.min[axis]) - origin_[axis]);
        result.max[axis] = saturated(-below(-box.max[axis]) - origin_[axis]);
      } else {
        result.min[axis] = kLast, result.max[axis] = kFirst;
      }
    }
    return result;
  }

 private:
  static constexpr Int kFirst = std::numeric_limits<Int>::min();
  static constexpr Int kLast = std::numeric_limits<Int>::max();
  static constexpr double kMost = std::numeric_limits<double>::max();

  // Whole steps: exact, for the step is a power of two, but where the quotient falls below the least number.
  [[nodiscard]] double below(double value) const {
    const double steps = std::floor(value / resolution_);
    const bool lost = rounding::magnitude(steps) == 0 && rounding::negative(value) && rounding::magnitude(value) != 0;
    return lost ? -1 : steps;
  }

  [[nodiscard]] static Int saturated(double steps) {
    return static_cast<Int>(std::clamp(steps, static_cast<double>(kFirst), static_cast<double>(kLast)));
  }

  double resolution_;
  Point origin_;  // in steps
};

}  // namespace sweepgrid
