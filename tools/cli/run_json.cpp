#include "cli/run_json.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "cli/cell_names.hpp"
#include "cli/provenance_json.hpp"
#include "setup/setup_json.hpp"

namespace sweepgrid {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSchemaVersion = 2;

template <class T>
Json optional_json(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json settings_json(const RunOptions& options, int workers) {
  const EngineSetup setup = setup_of(options);
  const Config& config = setup.config;
  return {{"threads", options.thread_count()},
          {"workers", workers},
          {"cell", cell_name(config.cell.kind)},
          {"cell_size", config.cell_size ? Json(*config.cell_size) : Json("auto")},
          {"cell_population", config.cell_population ? Json(*config.cell_population) : Json("auto")},
          {"segment_capacity",
           options.setup ? Json(config.cell.segment_capacity) : optional_json(options.segment_capacity)},
          {"reduction", reduction_name(config.reduction)},
          {"step_method", step_method_name(config.step_method)},
          {"scalar", scalar_name(setup.treatment.door)},
          {"config", options.setup ? setup_json(setup) : Json(nullptr)},
          {"steps", optional_json(options.steps)},
          {"diameter", optional_json(options.scene.diameter)},
          {"verify", options.verify}};
}

Json scene_json(const SceneInfo& scene) {
  Json details = Json::object();
  for (const auto& [name, value] : scene.details) details[name] = value;
  Json bounds = nullptr;
  if (scene.bounds) bounds = {{"min", scene.bounds->min}, {"max", scene.bounds->max}};
  return {{"name", scene.name}, {"format", scene.format}, {"compression", scene.compression},
          {"dim", scene.dim},   {"bounds", bounds},       {"details", details}};
}

Json times_json(const StepTimes& times) {
  const auto& samples = times.samples;
  return {{"median", times.median()},
          {"p99", times.p99()},
          {"mean", times.mean()},
          {"min", samples.empty() ? 0 : *std::min_element(samples.begin(), samples.end())},
          {"max", samples.empty() ? 0 : *std::max_element(samples.begin(), samples.end())},
          {"samples", samples}};
}

Json counters_json(const StepCounters& counters) {
  return {{"inserts", counters.inserts},
          {"updates", counters.updates},
          {"erases", counters.erases},
          {"migrations", counters.migrations},
          {"sweeps", counters.sweeps},
          {"cell_ops", counters.cell_ops},
          {"cells_drained", counters.cells_drained},
          {"regrids", counters.regrids},
          {"begins", counters.begins},
          {"ends", counters.ends},
          {"swaps", counters.cells.swaps},
          {"box_tests", counters.cells.box_tests},
          {"deltas", counters.cells.deltas},
          {"endpoints_visited", counters.cells.endpoints_visited},
          {"endpoints_sorted", counters.cells.endpoints_sorted},
          {"search_steps", counters.cells.search_steps},
          {"local_sorts", counters.cells.local_sorts},
          {"global_sorts", counters.cells.global_sorts},
          {"segments_split", counters.cells.segments_split},
          {"segments_merged", counters.cells.segments_merged}};
}

Json verification_json(const std::optional<Verification>& verification) {
  if (!verification) return nullptr;
  return {{"ok", verification->ok()},
          {"promised", guarantee_name(verification->promised)},
          {"steps", verification->steps},
          {"pairs", verification->pairs},
          {"missing", verification->missing},
          {"extra", verification->extra},
          {"duplicate", verification->duplicate},
          {"spurious", verification->spurious},
          {"misordered", verification->misordered},
          {"first_error", verification->ok() ? Json(nullptr) : Json(verification->first_error)}};
}

Json result_json(const SceneResult& result) {
  Json stages = Json::object();
  for (const StageTime& stage : result.stage_totals) stages[stage.stage] = 1000 * stage.seconds;
  const Stats& stats = result.stats;
  return {{"scene", scene_json(result.scene)},
          {"error", result.error.empty() ? Json(nullptr) : Json(result.error)},
          {"steps", result.steps},
          {"objects", {{"first", result.objects_first}, {"last", result.objects_last}}},
          {"pairs", {{"first", result.pairs_first}, {"last", result.pairs_last}}},
          {"moved", result.moved},
          {"inserts", result.inserts},
          {"erases", result.erases},
          {"begins", result.begins},
          {"ends", result.ends},
          {"start_ms", result.start_ms},
          {"whole_ms", times_json(result.whole_times)},
          {"step_ms", times_json(result.step_times)},
          {"stages_ms", stages},
          {"memory_bytes",
           {{"peak", result.peak_bytes},
            {"engine", stats.bytes()},
            {"objects", stats.bytes_objects},
            {"cells", stats.bytes_cells},
            {"queues", stats.bytes_queues},
            {"witnesses", stats.bytes_witnesses}}},
          {"grid", {{"grids", stats.grids}, {"cells", stats.cells}, {"cell_size", stats.cell_size}}},
          {"counters", counters_json(stats.total)},
          {"verification", verification_json(result.verification)}};
}

}  // namespace

std::string run_json(const RunOptions& options, int workers, const std::vector<SceneResult>& results) {
  Json scenes = Json::array();
  for (const SceneResult& result : results) scenes.push_back(result_json(result));
  const Json document = {{"schema", "sweepgrid-run"},
                         {"schema_version", kSchemaVersion},
                         {"build", build_json()},
                         {"machine", machine_json()},
                         {"settings", settings_json(options, workers)},
                         {"scenes", scenes}};
  // Names of files need not be UTF-8.
  return document.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sweepgrid
