#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sweepgrid {

/// A task of which only the time matters.
struct WorkTask {
  double seconds = 0;       ///< on a machine that it has for itself
  std::uint64_t size = 0;   ///< the cost that was estimated for it before it ran, as a StageGraph::Plan does
  double memory_share = 0;  ///< part of `seconds` that is bound by the bandwidth of memory, in [0, 1]
};

/// A stage as a StageGraph runs it: when all of `after` have ended, one worker does the serial part (the plan), then
/// the tasks may run in any order on any workers. A stage without tasks is a serial part alone.
struct WorkStage {
  std::string name;
  std::vector<std::uint32_t> after;  ///< earlier stages
  double serial = 0;                 ///< seconds
  std::vector<WorkTask> tasks;
};

/// Recorded work and what waits for what; stages in an order in which they could run one after another.
using WorkGraph = std::vector<WorkStage>;

/// What bounds every schedule of a work graph, in seconds. On P workers none is shorter than work / P, nor than span,
/// so no speed-up exceeds min(P, work / span); a greedy schedule without costs takes at most
/// work / P + (1 - 1 / P) * span (Graham 1969; Brent 1974).
struct WorkAndSpan {
  double work = 0;    ///< all tasks and serial parts
  double span = 0;    ///< the critical path: the longest chain of serial parts and longest tasks
  double serial = 0;  ///< serial parts alone
  /// Amdahl's: the part of the work during which the others have nothing to do.
  [[nodiscard]] double serial_share() const { return work > 0 ? serial / work : 0; }
};

/// Throws std::invalid_argument that names the stage when a time is negative or not finite, a memory share is not
/// within 0 and 1, or a stage waits for itself or a later one.
[[nodiscard]] WorkAndSpan work_and_span(const WorkGraph& graph);

}  // namespace sweepgrid
