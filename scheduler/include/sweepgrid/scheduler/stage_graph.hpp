#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <sweepgrid/scheduler/executor.hpp>
#include <sweepgrid/scheduler/task_trace.hpp>

namespace sweepgrid {

/// The stages of a step and what each waits for: a task graph whose nodes are stages, and whose stages are sets of
/// independent tasks. Built once, run every step.
class StageGraph {
 public:
  using StageId = std::uint32_t;

  /// Called when all stages that this one waits for have ended; leaves one estimated cost per task in `costs` (empty
  /// on entry). The unit is the stage's own; only ratios count. No task: the body is not called.
  using Plan = std::function<void(std::vector<std::uint64_t>& costs)>;
  using Body = std::function<void(std::size_t task)>;

  explicit StageGraph(std::shared_ptr<Executor> executor);
  ~StageGraph();
  StageGraph(const StageGraph&) = delete;
  StageGraph& operator=(const StageGraph&) = delete;

  /// Adds a stage that starts when every stage in `after` has ended. Throws std::invalid_argument when `after` names a
  /// stage that was not added yet, so no cycle can be built.
  StageId add(std::string name, const std::vector<StageId>& after, Plan plan, Body body);

  /// Runs every stage once and returns when all have ended. The heaviest tasks of a stage start first; idle workers
  /// steal. The first exception of a plan or body is rethrown after running tasks ended; stages that had not
  /// started are skipped, the trace is empty, and the graph can be run again: nothing of a run that failed is left.
  /// Beside that it throws only what allocation throws.
  ///
  /// `alone`: the calling thread does all of it, outside of the executor's arena; for so little work that to wake a
  /// worker would take longer. What a plan or body asks of the executor by itself goes there all the same.
  void run(bool alone = false);

  /// Whether run() keeps a record of every task. Off at first, and free when off.
  void record(bool on);
  [[nodiscard]] const TaskTrace& trace() const;

  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] const std::string& name(StageId stage) const;
  /// Wall time of the stage in the latest run, plan included.
  [[nodiscard]] double seconds(StageId stage) const;
  /// Heap bytes held, without what oneTBB holds, and what plans and bodies do.
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sweepgrid
