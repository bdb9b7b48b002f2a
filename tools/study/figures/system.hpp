#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <sweepgrid/sap/cell_kind.hpp>
#include <sweepgrid/sap/ids.hpp>
#include <sweepgrid/sap/sap_counters.hpp>

#include "study/figures/script.hpp"

namespace sweepgrid::study {

/// What was counted since `before`.
[[nodiscard]] inline SapCounters added_since(SapCounters counters, const SapCounters& before) {
  counters.swaps -= before.swaps;
  counters.box_tests -= before.box_tests;
  counters.deltas -= before.deltas;
  counters.endpoints_visited -= before.endpoints_visited;
  counters.endpoints_sorted -= before.endpoints_sorted;
  counters.search_steps -= before.search_steps;
  counters.local_sorts -= before.local_sorts;
  counters.global_sorts -= before.global_sorts;
  counters.segments_split -= before.segments_split;
  counters.segments_merged -= before.segments_merged;
  return counters;
}

/// Exact counts of what a system did; those that it does not keep are 0.
struct Work {
  SapCounters cells;
  std::uint64_t updates = 0;
  std::uint64_t cell_ops = 0;
  std::uint64_t cells_drained = 0;
  std::uint64_t events = 0;

  [[nodiscard]] Work operator-(const Work& before) const {
    return {added_since(cells, before.cells), updates - before.updates, cell_ops - before.cell_ops,
            cells_drained - before.cells_drained, events - before.events};
  }
};

/// A broad phase that is timed: told what changed, it finds what that leads to. One thread.
class System {
 public:
  virtual ~System() = default;

  /// A whole step, timed: from boxes at hand to events, overlap deltas or pairs at hand.
  virtual void step(const ScriptStep& changes) = 0;

  /// Between two steps, not timed: what only the check of the pairs needs.
  virtual void settle() {}

  /// Overlapping pairs as of the latest step, sorted. Not timed.
  [[nodiscard]] virtual std::vector<PairKey> pairs() = 0;

  [[nodiscard]] virtual Work work() const = 0;
};

/// Where a system keeps its objects.
enum class Layout {
  kOneCell,  ///< one cell and nothing around it; its overlap deltas are the result
  kGrid,     ///< the engine as the paper has it: one grid of such cells, witness counts (sections 3.1 and 3.3)
  kEngine,   ///< the engine with its defaults, which chooses grids, kinds and the way to events by itself
  kOctree    ///< the baseline
};

/// A system to be. Only what its layout knows is used.
struct SystemSpec {
  std::string name;
  Layout layout = Layout::kOneCell;
  CellOptions cell = {};
  double population = 300;  ///< objects per cell of a grid, with those that reach into it
  int pieces = 1;           ///< drains that a step's ops are given to a cell in
  double x = 0;             ///< where its result stands on the figure's axis
};

[[nodiscard]] std::unique_ptr<System> make_system(const SystemSpec& spec, const Script& script);

/// Edge of the cells of a grid over the script's world that hold `population` objects in the mean: whole cells, as
/// many along each axis as come closest. Objects are unit cubes and are in each cell that they reach into.
[[nodiscard]] double grid_cell_size(double population, const Script& script);

}  // namespace sweepgrid::study
