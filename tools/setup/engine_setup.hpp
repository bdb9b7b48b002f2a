#pragma once

#include <sweepgrid/engine/config.hpp>

#include "setup/treatment.hpp"

namespace sweepgrid {

/// Everything that decides how an engine runs over a scene, its type of numbers and its dimensions among it.
struct EngineSetup {
  Treatment treatment;
  /// For the engine that comes of it, in its units.
  Config config;
};

}  // namespace sweepgrid
