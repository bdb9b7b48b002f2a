#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <sweepgrid/sap/box.hpp>

#include "scenes/scene_source.hpp"

namespace sweepgrid {

/// A scene's box in the engine's precision and dimension. Coordinates are rounded to nearest, so min <= max stays true.
template <class Scalar, int Dim>
[[nodiscard]] Box<Scalar, Dim> round_box(const SceneBox& box) {
  Box<Scalar, Dim> result;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(Dim); ++axis) {
    result.min[axis] = static_cast<Scalar>(box.min[axis]);
    result.max[axis] = static_cast<Scalar>(box.max[axis]);
  }
  return result;
}

/// The same numbers in double, exactly. Axes that `box` has not are [0, 0]. Of boxes in memory: in one expression with
/// round_box(), g++ 12 vectorises the rounding of some ends away.
template <class Scalar, int Dim>
[[nodiscard]] SceneBox widen_box(const Box<Scalar, Dim>& box) {
  SceneBox result{};
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(Dim); ++axis) {
    result.min[axis] = box.min[axis];
    result.max[axis] = box.max[axis];
  }
  return result;
}

/// Rounds `boxes` to `rounded`, for the engine, and in place, so that both hold the same numbers.
template <class Scalar, int Dim>
void round_boxes(std::vector<SceneBox>& boxes, std::vector<Box<Scalar, Dim>>& rounded) {
  rounded.clear();
  for (SceneBox& box : boxes) {
    rounded.push_back(round_box<Scalar, Dim>(box));
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(Dim); ++axis) {
      box.min[axis] = rounded.back().min[axis];
      box.max[axis] = rounded.back().max[axis];
    }
  }
}

}  // namespace sweepgrid
