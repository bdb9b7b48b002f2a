#pragma once

#include <stdexcept>

namespace sweepgrid {

/// A scene that cannot be read. The message names the file, the line or byte offset, and the reason; or the generator
/// and the parameter.
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace sweepgrid
