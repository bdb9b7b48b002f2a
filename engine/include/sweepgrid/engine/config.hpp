#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <sweepgrid/engine/envelope_options.hpp>
#include <sweepgrid/sap/cell_options.hpp>
#include <sweepgrid/scheduler/executor.hpp>

namespace sweepgrid {

/// How the overlap deltas of cells become events. A pair may overlap in several cells.
enum class Reduction {
  /// The one cell that holds the lower corner of a pair's intersection reports it, judging by the boxes alone; no set
  /// of pairs is kept. Grids of several cell sizes serve objects of different sizes.
  kSingleReporter,
  /// A table counts for every pair the cells in which it overlaps (the paper, section 3.3). One grid, bounded where the
  /// scene was when it was derived, and rebuilt within one step when that no longer fits.
  kWitnessCounts,
};

/// How a step finds out which pairs have changed.
enum class StepMethod {
  /// The way that costs less by what has changed since the latest step.
  kAuto,
  /// Through cells, which are kept up to date: costs what has changed.
  kCells,
  /// By sweeping all objects from scratch, and no cells are kept: costs what there is. Where that is not possible, as
  /// kCells: with witness counts, other cells than rows, and more than 4 axes.
  kSweep,
};

/// Settings of an engine. Of them, only `envelope` has a say in which pairs there are, and `step_bytes` in whether a
/// step is done or refused; the others in time and memory. The defaults suit most scenes.
struct Config {
  /// Kind of the cells and its parameters.
  CellOptions cell;
  /// Edge of the finest cells in world units, positive and finite; absent: derived from the boxes, and derived anew
  /// when the scene changes. With witness counts, doubled while the grid would have more than 2^24 cells if given, more
  /// than 4096 and one for each object if derived.
  std::optional<double> cell_size;
  /// Objects per cell that a derived cell size aims at (centres of boxes beside the object's own), at least 1; absent:
  /// what costs least by a model of the kind of cells.
  std::optional<int> cell_population;
  /// How deltas become events.
  Reduction reduction = Reduction::kSingleReporter;
  /// How steps work.
  StepMethod step_method = StepMethod::kAuto;
  /// Margins, swept boxes, strides: accuracy for time. Absent: none, and pairs are exact.
  std::optional<EnvelopeOptions> envelope;
  /// Most bytes that the lists of one step may take: 16 for every call to a cell or, in a sweep, entry in a row, 16 for
  /// every overlap delta (32 with witness counts), and for every event 8 and twice the size of its keys. Lists double
  /// as they grow, so that memory for two to three times as much is needed. Absent: as memory lasts. A step beyond it
  /// is refused, see Engine::step(). Whether it is does not depend on the number of threads.
  std::optional<std::uint64_t> step_bytes;
  /// Where the step runs; absent: `threads` workers of the engine's own (0: as many as the machine has; 1: none).
  std::shared_ptr<Executor> executor;
  int threads = 0;
  /// Calls that a step must apply to be shared among workers, not negative: to wake them takes as long as one worker
  /// takes for some hundred calls. Steps that apply fewer, and sweeps of fewer than four times as many objects, are
  /// done by the thread that calls step(). Whether they are is judged by counts, a sample of them where there are many.
  int parallel_from = 1000;
};

}  // namespace sweepgrid
