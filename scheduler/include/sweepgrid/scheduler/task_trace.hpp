#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sweepgrid {

/// One task as it ran.
struct TaskRecord {
  std::uint32_t stage = 0;  ///< StageGraph::StageId
  std::uint32_t task = 0;   ///< index among the stage's tasks
  std::uint64_t size = 0;   ///< the cost that was estimated for it
  std::int32_t worker = 0;
  std::int64_t start_ns = 0;  ///< since the beginning of the run
  std::int64_t duration_ns = 0;
};

/// The tasks of the latest run of a stage graph, by stage, then by task. Not thread-safe.
using TaskTrace = std::vector<TaskRecord>;

}  // namespace sweepgrid
