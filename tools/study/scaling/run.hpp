#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <sweepgrid/scheduler/executor.hpp>
#include <sweepgrid/scheduler/recording_executor.hpp>
#include <sweepgrid/scheduler/work_graph.hpp>

#include "study/scaling/scene.hpp"

namespace sweepgrid::study {

/// The engine's settings that a scaling study varies; the others are the defaults.
struct ScalingSettings {
  std::optional<int> cell_population;
};

/// Wall times of one step, in seconds.
struct ScalingTimes {
  double queueing = 0;         ///< telling what changes, in bulk
  std::vector<double> stages;  ///< of step()
  double step = 0;             ///< step() as a whole

  /// Queueing, stages, and what step() does beside them.
  [[nodiscard]] std::vector<double> parts() const;
};

/// A task as it ran, in seconds from the beginning of its step.
struct RanTask {
  std::string stage;
  int worker = 0;
  double start = 0;
  double duration = 0;
};

/// One run of the engine over a scene.
struct ScalingRun {
  std::vector<std::string> stages;
  std::vector<ScalingTimes> steps;  ///< those after the start
  std::uint64_t events = 0;
  std::uint64_t checksum = 0;   ///< of the stream of events, the start's with them
  std::vector<WorkGraph> work;  ///< with a recorder: of each step after the start
  /// With a recorder: seconds in tasks by stage and worker, over all steps after the start.
  std::vector<std::vector<double>> busy;
  std::vector<RanTask> last_step;  ///< with a recorder
};

/// Runs the engine over `scene`. With `recorder`, which then is the engine's executor, tasks are recorded.
[[nodiscard]] ScalingRun run_scaling(const SceneScript& scene, const ScalingSettings& settings,
                                     const std::shared_ptr<Executor>& executor, RecordingExecutor* recorder);

/// The work of every step after the start when it is cut for `workers` workers, done by the calling thread alone, in
/// its processor time: of `runs` runs the least of each task and serial part, for what disturbs only adds.
[[nodiscard]] std::vector<WorkGraph> record_work(const SceneScript& scene, const ScalingSettings& settings, int workers,
                                                 int runs);

/// Makes each of `least` the lesser of itself and `other`. Throws std::runtime_error when the two have not the same
/// tasks: what an engine does must not depend on time.
void keep_least(std::vector<WorkGraph>& least, const std::vector<WorkGraph>& other);

/// What a step takes by the least times of its parts over `runs`, for each step.
[[nodiscard]] std::vector<double> least_step_seconds(const std::vector<ScalingRun>& runs);
/// The same by part, over all steps.
[[nodiscard]] std::vector<double> least_part_seconds(const std::vector<ScalingRun>& runs);

struct ScalingCheck {
  bool ok = true;
  std::string error;
  std::uint64_t checksum = 0;       ///< of the events that were checked
  std::uint64_t steps_checked = 0;  ///< after which the pairs were compared, the start among them
  std::uint64_t pairs = 0;          ///< compared in all of them
};

/// Runs the engine on one thread and compares the pairs that its events lead to with those that a sort and a sweep find
/// in the boxes: after every step, or where that would take too long (above 2e5 objects) after the start and the last.
[[nodiscard]] ScalingCheck check_scaling(const SceneScript& scene);

}  // namespace sweepgrid::study
