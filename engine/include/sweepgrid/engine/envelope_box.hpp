#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/sap/ordered_box.hpp>
#include <sweepgrid/sap/rounding.hpp>

// What envelopes are made of. Whatever has to be rounded is rounded outward.
namespace sweepgrid {

/// The box grown by `margin` on every side.
template <class Scalar, int Dim>
[[nodiscard]] Box<Scalar, Dim> grown(const Box<Scalar, Dim>& box, double margin) {
  Box<Scalar, Dim> result;
  for (int axis = 0; axis < Dim; ++axis) {
    result.min[axis] = sum_below(box.min[axis], margin);
    result.max[axis] = sum_above(box.max[axis], margin);
  }
  return result;
}

/// What the box covers while it moves by `displacement`.
template <class Scalar, int Dim>
[[nodiscard]] Box<Scalar, Dim> swept(const Box<Scalar, Dim>& box,
                                     const std::type_identity_t<std::array<double, Dim>>& displacement) {
  Box<Scalar, Dim> result;
  for (int axis = 0; axis < Dim; ++axis) {
    result.min[axis] = sum_below(box.min[axis], std::max(0.0, -displacement[axis]));
    result.max[axis] = sum_above(box.max[axis], std::max(0.0, displacement[axis]));
  }
  return result;
}

// By ordered bits, as cells compare: these tell denormals apart where the host flushes them to zero.

/// The least box that holds both.
template <class Scalar, int Dim>
[[nodiscard]] Box<Scalar, Dim> hull(const Box<Scalar, Dim>& a, const Box<Scalar, Dim>& b) {
  Box<Scalar, Dim> result;
  for (int axis = 0; axis < Dim; ++axis) {
    result.min[axis] = ordered_bits(b.min[axis]) < ordered_bits(a.min[axis]) ? b.min[axis] : a.min[axis];
    result.max[axis] = ordered_bits(b.max[axis]) > ordered_bits(a.max[axis]) ? b.max[axis] : a.max[axis];
  }
  return result;
}

template <class Scalar, int Dim>
[[nodiscard]] bool holds(const Box<Scalar, Dim>& outer, const Box<Scalar, Dim>& inner) {
  const OrderedBox<Scalar, Dim> a(outer);
  const OrderedBox<Scalar, Dim> b(inner);
  unsigned inside = 1;  // without branches
  for (int axis = 0; axis < Dim; ++axis) {
    inside &= unsigned{a.min[axis] <= b.min[axis]} & unsigned{b.max[axis] <= a.max[axis]};
  }
  return inside != 0;
}

/// How much wider `outer` is than `inner` on the axis where that is most. Infinite edges do not count.
template <class Scalar, int Dim>
[[nodiscard]] double slack(const Box<Scalar, Dim>& outer, const Box<Scalar, Dim>& inner) {
  double most = 0;
  for (int axis = 0; axis < Dim; ++axis) {
    const double below = static_cast<double>(inner.min[axis]) - static_cast<double>(outer.min[axis]);
    const double above = static_cast<double>(outer.max[axis]) - static_cast<double>(inner.max[axis]);
    most = std::max(most, below + above);  // passes over NaN
  }
  return most;
}

/// The farthest that an end has gone on any axis; infinite ends do not count.
template <class Scalar, int Dim>
[[nodiscard]] double displacement(const Box<Scalar, Dim>& from, const Box<Scalar, Dim>& to) {
  double most = 0;
  for (int axis = 0; axis < Dim; ++axis) {
    const double lower = std::fabs(static_cast<double>(to.min[axis]) - static_cast<double>(from.min[axis]));
    const double upper = std::fabs(static_cast<double>(to.max[axis]) - static_cast<double>(from.max[axis]));
    if (std::isfinite(lower)) most = std::max(most, lower);
    if (std::isfinite(upper)) most = std::max(most, upper);
  }
  return most;
}

}  // namespace sweepgrid
