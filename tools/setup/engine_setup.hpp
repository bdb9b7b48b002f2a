#pragma once

#include <sweepgrid/engine/config.hpp>

#include "setup/treatment.hpp"

namespace sweepgrid {

/// Everything that decides how an engine runs over a scene, its type of numbers and its dimensions among it.
struct EngineSetup {
  Treatment treatment;
  /// For the engine that comes of it, in its units; config_as() gives it the type.
  Config<double, 3> config;
};

/// The same settings for an engine of another type. All units stay.
template <class Scalar, int Dim>
[[nodiscard]] Config<Scalar, Dim> config_as(const Config<double, 3>& config) {
  Config<Scalar, Dim> result;
  result.cell = config.cell;
  result.cell_size = config.cell_size;
  result.cell_population = config.cell_population;
  result.reduction = config.reduction;
  result.envelope = config.envelope;
  result.step_bytes = config.step_bytes;
  result.executor = config.executor;
  result.threads = config.threads;
  return result;
}

}  // namespace sweepgrid
