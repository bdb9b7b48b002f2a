#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <sweepgrid/engine/stats.hpp>
#include <sweepgrid/scheduler/executor.hpp>

#include "cli/events_file.hpp"
#include "cli/run_options.hpp"
#include "cli/step_times.hpp"
#include "cli/verifier.hpp"
#include "scenes/scene_source.hpp"

namespace sweepgrid {

/// What running the engine over one scene came to. The counts do not include the start unless they say so.
struct SceneResult {
  SceneInfo scene;
  /// Why the scene could not be read, or not to its end; empty: it could. All else is of the steps before that.
  std::string error;
  bool started = false;  ///< the start, at least, was read
  std::uint64_t steps = 0;
  std::size_t objects_first = 0;  ///< after the start
  std::size_t objects_last = 0;
  std::size_t pairs_first = 0;
  std::size_t pairs_last = 0;
  std::uint64_t moved = 0;  ///< updates queued
  std::uint64_t inserts = 0;
  std::uint64_t erases = 0;
  std::uint64_t begins = 0;
  std::uint64_t ends = 0;

  double start_ms = 0;                  ///< queueing the start and its step()
  StepTimes whole_times;                ///< queueing a step's ops and step()
  StepTimes step_times;                 ///< step() alone
  std::vector<StageTime> stage_totals;  ///< of all steps but the start

  Stats stats;  ///< after the last step
  std::uint64_t peak_bytes = 0;
  std::optional<Verification> verification;
};

/// Runs the engine over `source`. Reading the scene, looking up handles, writing events and verifying are not timed.
/// A SceneError ends the run, as the scene's end does, and is told in the result. `events` may be null.
[[nodiscard]] SceneResult run_scene(SceneSource& source, const RunOptions& options,
                                    const std::shared_ptr<Executor>& executor, EventsFile* events);

}  // namespace sweepgrid
