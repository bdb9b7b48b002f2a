#include "cli/run_command.hpp"

#include <cstdio>
#include <memory>
#include <optional>
#include <vector>

#include <sweepgrid/scheduler/executor.hpp>

#include "cli/events_file.hpp"
#include "cli/output_file.hpp"
#include "cli/run_json.hpp"
#include "cli/run_table.hpp"
#include "cli/scene_run.hpp"

namespace sweepgrid {

bool run_command(const RunOptions& options) {
  const std::shared_ptr<Executor> executor = make_executor(options.thread_count());
  // Opened before the work, so that a path that cannot be written to costs none.
  std::optional<EventsFile> events;
  if (!options.events_path.empty()) events.emplace(options.events_path, options.scenes.size());
  std::optional<OutputFile> json;
  if (!options.json_path.empty()) json.emplace(options.json_path);
  const bool stdout_taken = options.events_path == "-" || options.json_path == "-";
  const RunTable table(stdout_taken ? stderr : stdout, options.scenes);
  table.print_head();
  std::vector<SceneResult> results;
  bool all_right = true;
  for (const std::string& scene : options.scenes) {
    const std::unique_ptr<SceneSource> source = open_scene(scene, options.scene);
    if (events) events->begin_scene();
    results.push_back(run_scene(*source, options, executor, events ? &*events : nullptr));
    const SceneResult& result = results.back();
    table.print_row(result);
    if (result.verification && !result.verification->ok()) all_right = false;
  }
  if (events) events->commit();
  if (json) {
    json->write(run_json(options, executor->concurrency(), results));
    json->commit();
  }
  return all_right;
}

}  // namespace sweepgrid
