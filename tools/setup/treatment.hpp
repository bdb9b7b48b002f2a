#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "scenes/scene_source.hpp"

namespace sweepgrid {

/// How a scene's boxes, which are in double, come into an engine.
enum class Door {
  kDouble,        ///< as they are
  kFloatNearest,  ///< rounded to the nearest float: min <= max of two ends stays true, so a superset
  kFloatOutward,  ///< round_outward()
  kInt32,         ///< Quantizer
  kInt16,
};

[[nodiscard]] constexpr bool is_float(Door door) { return door == Door::kFloatNearest || door == Door::kFloatOutward; }
[[nodiscard]] constexpr bool is_integer(Door door) { return door == Door::kInt32 || door == Door::kInt16; }

/// What becomes of a scene on its way to an engine: the engine's type of numbers and dimensions follow from it.
struct Treatment {
  Door door = Door::kFloatNearest;
  /// Axes that the engine sees, two or three of 0, 1 and 2, in this order; empty: all that the scene has. Boxes that
  /// overlap do so without an axis, too: a superset.
  std::vector<std::size_t> axes;
  /// Of integers: what becomes 0, and the step of one in the scene's units.
  std::array<double, 3> origin{};
  double resolution = 1;
};

/// The axes of an engine for a scene of so many dimensions.
[[nodiscard]] inline std::vector<std::size_t> axes_of(const Treatment& treatment, int dim) {
  if (!treatment.axes.empty()) return treatment.axes;
  return dim == 2 ? std::vector<std::size_t>{0, 1} : std::vector<std::size_t>{0, 1, 2};
}

/// Units of the engine for one of the scene.
[[nodiscard]] inline double scale_of(const Treatment& treatment) {
  return is_integer(treatment.door) ? 1 / treatment.resolution : 1;
}

/// Integers of `door` whose steps are the finest with which all of `world` fits. Throws std::invalid_argument unless
/// that is valid and finite. No other door changes.
[[nodiscard]] Treatment covering(Door door, const SceneBox& world);

}  // namespace sweepgrid
