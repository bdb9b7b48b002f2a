#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <streambuf>
#include <string>

#include "scenes/scene_source.hpp"

namespace sweepgrid {

struct SceneOptions {
  /// Of the atoms of a LAMMPS dump without a radius column. Not negative.
  std::optional<double> diameter;
  /// A LAMMPS dump whose boxes reach beyond this, or beyond its negative, is refused: 1e39 is infinite as a float.
  double largest = std::numeric_limits<double>::max();
};

/// Opens a recording, whose format and compression are told by its content, or a generator such as
/// "uniform:n=1000,steps=10" (see generator_params.hpp). A file with the name of a generator is reached as ./NAME.
/// Throws SceneError.
[[nodiscard]] std::unique_ptr<SceneSource> open_scene(const std::string& spec, const SceneOptions& options = {});

/// Reads a recording from `bytes`, for example a std::stringbuf, which it keeps; format and compression are told by the
/// content. `name`: of the scene and in errors. Throws SceneError.
[[nodiscard]] std::unique_ptr<SceneSource> open_recording(std::unique_ptr<std::streambuf> bytes,
                                                          const std::string& name, const SceneOptions& options = {});

}  // namespace sweepgrid
