// Every standard scene and recording with every setting of the engine, for Google Benchmark: its filter, repetitions
// and JSON. An iteration is all steps of a scene but the start; the exact counters are of one iteration.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/build_info.hpp"
#include "cli/cell_names.hpp"
#include "counter_table.hpp"
#include "engine_setting.hpp"
#include "measure/stopwatch.hpp"
#include "standard_scenes.hpp"
#include "system.hpp"

namespace sweepgrid::bench {
namespace {

/// Scripts that were asked for, so that a scene is read once for all settings, and only if the filter lets it through.
class ScriptCache {
 public:
  const SceneScript& script(const std::string& scene) {
    std::unique_ptr<SceneScript>& script = scripts_[scene];
    if (script == nullptr) script = std::make_unique<SceneScript>(read_script(scene, kMostSteps));
    return *script;
  }

 private:
  static constexpr std::uint64_t kMostSteps = 50;
  std::map<std::string, std::unique_ptr<SceneScript>> scripts_;
};

double timed_step(EngineSystem& system, const ScriptStep& changes) {
  const WallStopwatch stopwatch;
  system.queue(changes);
  system.step();
  return stopwatch.seconds();
}

void play(benchmark::State& state, const SceneScript& script, const Config& config) {
  double start_seconds = 0;
  double seconds = 0;
  std::uint64_t changes = 0;
  StepCounters counters;
  Stats stats;
  for (auto _ : state) {
    EngineSystem system(config, false, script.objects);
    start_seconds += timed_step(system, script.steps.front());
    double steps_seconds = 0;
    counters = {};
    for (std::size_t step = 1; step < script.steps.size(); ++step) {
      steps_seconds += timed_step(system, script.steps[step]);
      changes += script.steps[step].changes();
      stats = system.engine().stats();
      counters += stats.step;
    }
    state.SetIterationTime(steps_seconds);
    seconds += steps_seconds;
  }
  state.counters["ns_per_update"] = changes == 0 ? 0 : 1e9 * seconds / static_cast<double>(changes);
  state.counters["start_ms"] = 1e3 * start_seconds / static_cast<double>(state.iterations());
  for (const auto& [name, count] : named_counts(counters)) state.counters[name] = static_cast<double>(count);
  state.counters["pairs"] = static_cast<double>(stats.pairs);
  state.counters["bytes_per_object"] = static_cast<double>(stats.bytes()) / std::max(script.live, 1U);
}

void register_all(const std::shared_ptr<ScriptCache>& cache) {
  std::vector<NamedScene> scenes = standard_scenes();
  std::ranges::copy(recordings(SWEEPGRID_RECORDINGS), std::back_inserter(scenes));
  std::ranges::copy(large_scenes(), std::back_inserter(scenes));
  std::vector<std::string> settings = {"engine", "engine2"};
  for (const auto& [name, kind] : cell_kinds_by_name()) settings.push_back(name);
  for (const auto& [name, scene] : scenes) {
    for (const std::string& setting : settings) {
      benchmark::RegisterBenchmark(fmt::format("{}/{}", name, setting).c_str(),
                                   [cache, scene = scene, config = engine_setting(setting).value()](auto& state) {
                                     play(state, cache->script(scene), config);
                                   })
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace
}  // namespace sweepgrid::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::AddCustomContext("commit", sweepgrid::build_info().commit);
  sweepgrid::bench::register_all(std::make_shared<sweepgrid::bench::ScriptCache>());
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
