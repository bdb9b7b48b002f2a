#pragma once

#include <array>
#include <cstddef>

#include "tune/scene_sample.hpp"

namespace sweepgrid::tune {

/// What a sample shows, by counting alone: the same on every machine. Means are per measured step.
struct SceneFacts {
  double objects = 0;
  double least_edge = 0;  ///< of the longest edges of the boxes
  double most_edge = 0;
  double farthest = 0;      ///< of an object from the origin, in widths
  bool floats = true;       ///< every coordinate is one
  double updates = 0;       ///< mean
  double displacement = 0;  ///< of a moved object on the axis where it moved most: median, in widths
  double most_displacement = 0;
  double pairs = 0;                       ///< of boxes, at the ends of windows: mean
  std::array<double, 3> pairs_without{};  ///< likewise, with one axis left out
};

[[nodiscard]] SceneFacts find_facts(const SceneSample& sample);

/// Updates per measured step whose box leaves an envelope with this margin (in widths), made when the latest one was
/// left. Comes down from SceneFacts::updates as margins grow.
[[nodiscard]] double updates_outside(const SceneSample& sample, double margin);

/// Speed that EnvelopeOptions::margin_steps multiplies, in widths: the mean over all objects and measured steps, those
/// at rest included.
[[nodiscard]] double mean_speed(const SceneSample& sample, int stride);

}  // namespace sweepgrid::tune
