#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "scenes/scene_source.hpp"

namespace sweepgrid {

/// The least and the most of a number, and what it adds up to.
template <class T>
struct Range {
  T least = std::numeric_limits<T>::max();
  T most = std::numeric_limits<T>::lowest();
  double sum = 0;

  void take(T value) {
    least = std::min(least, value);
    most = std::max(most, value);
    sum += static_cast<double>(value);
  }
};

/// What a scene turns out to be when it is read to its end.
struct SceneCensus {
  std::string error;        ///< why it could not be read to its end; empty: it could. All else is of what was read
  bool started = false;     ///< the start, at least, was read
  std::uint64_t steps = 0;  ///< after the start
  std::size_t objects_first = 0;
  std::size_t objects_last = 0;
  Range<std::size_t> objects;
  Range<double> moved_part;  ///< per step: objects with another box, as part of those that lived on
  Range<std::size_t> moved;  ///< per step, as are the next two
  Range<std::size_t> inserted;
  Range<std::size_t> erased;
  std::uint64_t far_moved = 0;     ///< updates that moved the centre by more than 1 % of the box's largest width
  Range<double> width;             ///< largest edge of a box
  std::optional<SceneBox> extent;  ///< of all boxes at all times
  std::size_t pairs_first = 0;     ///< overlapping, boxes rounded to float
  std::size_t pairs_last = 0;
};

/// Reads `source` to its end, or for `steps` steps after the start. `rounded`: boxes are taken as float holds them.
/// A SceneError ends it and is told in the result.
[[nodiscard]] SceneCensus take_census(SceneSource& source, std::optional<std::uint64_t> steps, bool rounded);

}  // namespace sweepgrid
