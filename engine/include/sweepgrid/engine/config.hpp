#pragma once

#include <memory>
#include <optional>

#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/sap/cell_kind.hpp>
#include <sweepgrid/scheduler/executor.hpp>

namespace sweepgrid {

/// Settings of an engine. Events do not depend on any of them; time and memory do. The defaults suit most scenes.
template <class Scalar, int Dim>
struct Config {
  /// Kind of the cells and its parameters.
  CellOptions cell;
  /// Edge of a grid cell in world units, positive and finite; absent: derived from the boxes. With derived bounds it is
  /// doubled while the grid would have more than 4096 cells and eight for each object.
  std::optional<double> cell_size;
  /// The space that the grid divides, finite; absent: derived from the boxes. Objects outside are kept exactly in the
  /// cells at its border.
  std::optional<Box<Scalar, Dim>> bounds;
  /// Objects per occupied cell that a derived cell size aims at, at least 1.
  int cell_population = 48;
  /// Where the step runs; absent: `threads` workers of the engine's own (0: as many as the machine has; 1: none).
  std::shared_ptr<Executor> executor;
  int threads = 0;
};

}  // namespace sweepgrid
