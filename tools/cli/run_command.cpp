#include "cli/run_command.hpp"

#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <sweepgrid/scheduler/executor.hpp>

#include "cli/events_file.hpp"
#include "cli/output_file.hpp"
#include "cli/output_place.hpp"
#include "cli/run_json.hpp"
#include "cli/run_table.hpp"
#include "cli/scene_run.hpp"
#include "scenes/open_scene.hpp"
#include "scenes/scene_error.hpp"

namespace sweepgrid {
namespace {

// With the reader's limits for what the engine can hold.
SceneOptions scene_options(const RunOptions& options) {
  SceneOptions result = options.scene;
  if (setup_of(options).treatment.door == Door::kFloatNearest) result.largest = std::numeric_limits<float>::max();
  return result;
}

SceneResult run_named(const std::string& scene, const RunOptions& options, const std::shared_ptr<Executor>& executor,
                      EventsFile* events) {
  std::unique_ptr<SceneSource> source;
  try {
    source = open_scene(scene, scene_options(options));
  } catch (const SceneError& error) {
    SceneResult result;
    result.scene.name = scene;
    result.error = error.what();
    return result;
  }
  return run_scene(*source, options, executor, events);
}

std::string failure_of(const SceneResult& result) {
  if (!result.started) return result.error;
  return fmt::format("{}; the results are those of the {} whole frames before", result.error, result.steps + 1);
}

}  // namespace

bool run_command(const RunOptions& options) {
  const std::shared_ptr<Executor> executor = make_executor(options.thread_count());
  // Opened before the work, so that a path that cannot be written to costs none.
  std::optional<EventsFile> events;
  if (!options.events_path.empty()) events.emplace(options.events_path, options.scenes.size());
  std::optional<OutputFile> json;
  if (!options.json_path.empty()) json.emplace(options.json_path);
  const bool stdout_taken = is_standard_output(options.events_path) || is_standard_output(options.json_path);
  const RunTable table(stdout_taken ? stderr : stdout, options.scenes);
  table.print_head();
  std::vector<SceneResult> results;
  bool all_right = true;
  bool any_started = false;
  std::vector<std::string> failures;
  for (const std::string& scene : options.scenes) {
    if (events) events->begin_scene();
    results.push_back(run_named(scene, options, executor, events ? &*events : nullptr));
    const SceneResult& result = results.back();
    any_started = any_started || result.started;
    if (result.started) table.print_row(result);
    if (!result.error.empty()) failures.push_back(failure_of(result));
    if (result.verification && !result.verification->ok()) all_right = false;
  }
  const auto throw_failures = [&] {
    if (!failures.empty()) throw SceneError(fmt::format("{}", fmt::join(failures, "\nsweepgrid: ")));
  };
  if (!any_started) throw_failures();  // and leaves no files
  if (events) events->commit();
  if (json) {
    json->write(run_json(options, executor->concurrency(), results));
    json->commit();
  }
  throw_failures();
  return all_right;
}

}  // namespace sweepgrid
