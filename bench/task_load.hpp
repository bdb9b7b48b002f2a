#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <sweepgrid/scheduler/task_trace.hpp>

namespace sweepgrid::bench {

/// The tasks of one stage in one step.
struct StageLoad {
  std::size_t tasks = 0;
  double seconds = 0;  ///< of all of them
  double longest = 0;  ///< of the longest one, seconds
};

/// How the work of one step is cut into tasks, from several runs of that step.
///
/// With more workers than cores a task's wall time holds the time for which its worker was set aside, and a single run
/// tells little. Being set aside only ever adds, and hits another task each time, while the work of a task is the same
/// in all runs: so the shortest of a task's times, over runs of the same step, is its work, and the same holds for the
/// time in which no task runs.
class TaskLoad {
 public:
  /// `step_seconds`: wall time of step(). Throws std::runtime_error when the tasks are not those of the runs before.
  void add_run(const TaskTrace& trace, double queue_seconds, double step_seconds);

  /// By stage id; stages that had no task are absent.
  [[nodiscard]] std::map<std::uint32_t, StageLoad> stages() const;
  /// Of all tasks.
  [[nodiscard]] double work_seconds() const;
  /// Of step(), while no task ran.
  [[nodiscard]] double serial_seconds() const { return serial_; }
  [[nodiscard]] double queue_seconds() const { return queue_; }

 private:
  struct Task {
    std::uint32_t stage = 0;
    std::uint64_t size = 0;
    double seconds = 0;
  };

  std::vector<Task> tasks_;  // in the order of the trace
  double serial_ = 0;
  double queue_ = 0;
};

}  // namespace sweepgrid::bench
