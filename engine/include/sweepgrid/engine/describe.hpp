#pragma once

#include <sstream>
#include <string>

#include <sweepgrid/engine/handle.hpp>
#include <sweepgrid/sap/box.hpp>

namespace sweepgrid {

/// How an error message names an object.
[[nodiscard]] inline std::string describe(Handle handle) {
  return "object of handle " + std::to_string(handle.index) + " (generation " + std::to_string(handle.generation) + ")";
}

/// Why a box is not valid.
template <class Scalar, int Dim>
[[nodiscard]] std::string describe_fault(const Box<Scalar, Dim>& box) {
  for (int axis = 0; axis < Dim; ++axis) {
    if (in_order(box.min[axis], box.max[axis])) continue;
    const bool nan = !in_order(box.min[axis], box.min[axis]) || !in_order(box.max[axis], box.max[axis]);
    std::ostringstream out;
    out << "its box has " << (nan ? "a NaN" : "min > max") << " on axis " << axis << " (min " << box.min[axis]
        << ", max " << box.max[axis] << ")";
    return out.str();
  }
  return "its box is valid";
}

}  // namespace sweepgrid
