#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>

#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/sap/quantizer.hpp>
#include <sweepgrid/sap/rounding.hpp>

#include "scenes/rounded_step.hpp"
#include "setup/treatment.hpp"

namespace sweepgrid {

/// Makes an engine's box of a scene's. `door`: one whose numbers are of type `Scalar`; a template parameter, so that a
/// box costs no branch.
template <class Scalar, int Dim, Door door>
class BoxConversion {
 public:
  static constexpr auto kDim = static_cast<std::size_t>(Dim);

  /// `axes`: as many as the engine has.
  BoxConversion(const Treatment& treatment, const std::vector<std::size_t>& axes)
      : axes_(first(axes)), quantizer_(quantizer(treatment)) {}

  [[nodiscard]] Box<Scalar, Dim> operator()(const SceneBox& box) const {
    Box<double, Dim> kept;
    for (std::size_t axis = 0; axis < kDim; ++axis) {
      kept.min[axis] = box.min[axes_[axis]];
      kept.max[axis] = box.max[axes_[axis]];
    }
    if constexpr (door == Door::kDouble) {
      return kept;
    } else if constexpr (door == Door::kFloatOutward) {
      return round_outward<float>(kept);
    } else if constexpr (door == Door::kFloatNearest) {
      Box<float, Dim> rounded;
      for (std::size_t axis = 0; axis < kDim; ++axis) {
        rounded.min[axis] = static_cast<float>(kept.min[axis]);
        rounded.max[axis] = static_cast<float>(kept.max[axis]);
      }
      return rounded;
    } else {
      return quantizer_(kept);
    }
  }

 private:
  struct None {};
  template <class Number>
  struct QuantizerOf {
    using Type = None;
  };
  template <std::integral Number>
  struct QuantizerOf<Number> {
    using Type = Quantizer<Number, Dim>;
  };
  using QuantizerType = typename QuantizerOf<Scalar>::Type;

  static std::array<std::size_t, kDim> first(const std::vector<std::size_t>& axes) {
    std::array<std::size_t, kDim> result{};
    for (std::size_t axis = 0; axis < kDim; ++axis) result[axis] = axes.at(axis);
    return result;
  }
  [[nodiscard]] QuantizerType quantizer(const Treatment& treatment) const {
    if constexpr (std::integral<Scalar>) {
      std::array<double, kDim> origin;
      for (std::size_t axis = 0; axis < kDim; ++axis) origin[axis] = treatment.origin[axes_[axis]];
      return QuantizerType(origin, treatment.resolution);
    } else {
      return {};
    }
  }

  std::array<std::size_t, kDim> axes_;
  QuantizerType quantizer_;
};

}  // namespace sweepgrid
