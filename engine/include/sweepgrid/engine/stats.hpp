#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <sweepgrid/sap/sap_counters.hpp>

namespace sweepgrid {

/// Exact counts of one step. The same for every thread count, and for every order of updates and erases; the order of
/// inserts decides ids, and ids the order in which cells do their work.
struct StepCounters {
  SapCounters cells;                ///< the work inside the cells
  std::uint64_t inserts = 0;        ///< objects inserted (not those erased again before the step)
  std::uint64_t updates = 0;        ///< objects that lived on with a changed box
  std::uint64_t erases = 0;         ///< objects erased
  std::uint64_t migrations = 0;     ///< updates that changed the cell range
  std::uint64_t sweeps = 0;         ///< 1 when all objects were swept, and no cells kept; else 0
  std::uint64_t cell_ops = 0;       ///< ops queued to cells; an object in c cells counts c times. In a sweep: in c rows
  std::uint64_t cells_drained = 0;  ///< active cells. In a sweep: rows
  std::uint64_t regrids = 0;        ///< 1 when the grid was derived anew, else 0
  std::uint64_t begins = 0;
  std::uint64_t ends = 0;

  StepCounters& operator+=(const StepCounters& other);
  friend bool operator==(const StepCounters&, const StepCounters&) = default;
};

/// Wall time of one stage of the latest step.
struct StageTime {
  std::string stage;
  double seconds = 0;
};

/// What Engine::stats() returns.
struct Stats {
  StepCounters step;   ///< the latest step
  StepCounters total;  ///< all steps so far
  std::uint64_t steps = 0;
  std::uint64_t refused = 0;      ///< steps that Config::step_bytes did not allow; in no other figure
  std::vector<StageTime> stages;  ///< the latest step, in stage order; 0 when nothing was queued

  std::size_t objects = 0;
  std::size_t grids = 0;  ///< of different cell sizes
  std::size_t cells = 0;  ///< that hold an object
  double cell_size = 0;   ///< of the finest grid, world units; 0 while there are no cells
  std::size_t pairs = 0;  ///< overlapping now

  /// Heap bytes held now, unused capacity included; neither what keys hold of their own, nor what oneTBB does.
  std::size_t bytes_objects = 0;
  std::size_t bytes_cells = 0;
  std::size_t bytes_queues = 0;
  std::size_t bytes_witnesses = 0;
  [[nodiscard]] std::size_t bytes() const { return bytes_objects + bytes_cells + bytes_queues + bytes_witnesses; }
};

}  // namespace sweepgrid
