// Whether many workers would have enough to do: how evenly a step's work is cut into tasks, and what is left over that
// only one worker does.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <sweepgrid/scheduler/executor.hpp>

#include "engine_setting.hpp"
#include "figures_file.hpp"
#include "spread.hpp"
#include "stopwatch.hpp"
#include "system.hpp"
#include "task_load.hpp"

namespace sweepgrid::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::vector<std::string> scenes = {"uniform:n=100000,moving=1,churn=0", "clusters:n=100000,moving=1,churn=0",
                                     "pile:n=100000,moving=1,churn=0"};
  std::uint64_t steps = 10;
  int runs = 5;
  int threads = 64;
  bool alone = false;
  std::string json;
};

/// One thread in the place of many: tasks are cut as for all of them, and nothing waits for a thread to wake up.
class LoneExecutor final : public Executor {
 public:
  explicit LoneExecutor(int workers) : workers_(workers) {}

  [[nodiscard]] int concurrency() const override { return workers_; }
  [[nodiscard]] int worker() const override { return 0; }
  void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override {
    for (std::size_t i = 0; i < count; ++i) body(i);
  }
  void execute(const std::function<void()>& work) override { work(); }

 private:
  int workers_;
};

struct SceneLoad {
  std::vector<std::string> stage_names;
  std::vector<TaskLoad> steps;  // those after the start in which anything changes
};

SceneLoad load_of(const SceneScript& script, const Options& options) {
  auto config = engine_setting("engine").value();
  config.threads = options.threads;
  if (options.alone) config.executor = std::make_shared<LoneExecutor>(options.threads);
  SceneLoad load;
  for (int run = 0; run < options.runs; ++run) {
    EngineSystem system(config, false, script.objects);
    load.stage_names = system.engine().stage_names();
    system.engine().record_tasks(true);
    std::size_t busy_steps = 0;
    for (const ScriptStep& step : script.steps) {
      if (step.changes() == 0) continue;  // has no tasks
      const Stopwatch whole;
      system.queue(step);
      const double queue_seconds = whole.seconds();
      system.step();
      const double step_seconds = whole.seconds() - queue_seconds;
      if (&step == &script.steps.front()) continue;
      if (load.steps.size() == busy_steps) load.steps.emplace_back();
      load.steps[busy_steps++].add_run(system.engine().tasks(), queue_seconds, step_seconds);
    }
  }
  if (load.steps.empty()) throw std::runtime_error(script.scene + ": nothing changes after the start");
  return load;
}

/// Over the steps.
template <class Figure>
Spread over_steps(const SceneLoad& load, Figure&& figure) {
  std::vector<double> values;
  for (const TaskLoad& step : load.steps) values.push_back(figure(step));
  return spread(std::move(values));
}

// All that a step takes on one worker.
double whole_seconds(const TaskLoad& step) {
  return step.work_seconds() + step.serial_seconds() + step.queue_seconds();
}

// How many times faster `workers` could be at best: a stage takes as long as its longest task, or as its work takes
// when it is spread evenly; what is serial stays.
double most_speedup(const TaskLoad& step, int workers) {
  double seconds = step.serial_seconds() + step.queue_seconds();
  for (const auto& [id, stage] : step.stages()) seconds += std::max(stage.longest, stage.seconds / workers);
  return whole_seconds(step) / seconds;
}

/// Prints the stage's row.
Json stage_row(const SceneLoad& load, std::uint32_t id) {
  const auto of_stage = [&](auto&& figure) {
    return over_steps(load, [&](const TaskLoad& step) {
      const auto stages = step.stages();
      const auto found = stages.find(id);
      return found == stages.end() ? 0.0 : figure(found->second, step);
    });
  };
  const double tasks = of_stage([](const StageLoad& stage, auto&) { return static_cast<double>(stage.tasks); }).median;
  const double work = of_stage([](const StageLoad& stage, auto&) { return stage.seconds; }).median;
  const Spread longest =
      of_stage([](const StageLoad& stage, const TaskLoad& step) { return stage.longest / step.work_seconds(); });
  fmt::print("  {:<10} {:>6.0f} {:>10.3f} {:>12.2f} % {:>12.2f} %\n", load.stage_names[id], tasks, 1e3 * work,
             100 * longest.median, 100 * longest.high);
  return {{"stage", load.stage_names[id]},
          {"tasks", tasks},
          {"work_ms", 1e3 * work},
          {"longest_share", {{"median", longest.median}, {"max", longest.high}}}};
}

/// Prints the row of what is no task.
Json serial_row(const SceneLoad& load, const char* name, double (TaskLoad::*seconds)() const) {
  const double time = over_steps(load, [&](const TaskLoad& step) { return (step.*seconds)(); }).median;
  const Spread share = over_steps(load, [&](const TaskLoad& step) { return (step.*seconds)() / whole_seconds(step); });
  fmt::print("  {:<10} {:>6} {:>10.3f} {:>12.2f} % {:>12.2f} %\n", name, "-", 1e3 * time, 100 * share.median,
             100 * share.high);
  return {{"ms", 1e3 * time}, {"share", {{"median", share.median}, {"max", share.high}}}};
}

Json balance(const std::string& scene, const Options& options) {
  const SceneLoad load = load_of(read_script(scene, options.steps), options);
  fmt::print("{}\n  {:<10} {:>6} {:>10} {:>14} {:>14}\n", scene, "stage", "tasks", "work ms", "longest task",
             "in worst step");
  Json stages = Json::array();
  for (std::uint32_t id = 0; id < load.stage_names.size(); ++id) stages.push_back(stage_row(load, id));
  const Json serial = serial_row(load, "serial", &TaskLoad::serial_seconds);
  const Json queueing = serial_row(load, "queueing", &TaskLoad::queue_seconds);
  const double speedup =
      over_steps(load, [&](const TaskLoad& step) { return most_speedup(step, options.threads); }).median;
  fmt::print("  {} workers could be {:.1f} times faster than one\n", options.threads, speedup);
  std::fflush(stdout);
  return {{"scene", scene}, {"stages", stages}, {"serial", serial}, {"queueing", queueing}, {"most_speedup", speedup}};
}

int run(int argc, char** argv) {
  CLI::App app(
      "Runs the engine on more workers than the machine may have and tells, for each stage of a step, how many tasks "
      "there are and how long the longest is as a part of the work of all tasks of the step. serial: step() while no "
      "task runs; queueing: before step(); both as parts of the whole. Medians over the steps after the start.");
  Options options;
  app.add_option("scenes", options.scenes, "Recordings or generators, as `sweepgrid run` takes them")
      ->capture_default_str();
  app.add_option("--threads", options.threads, "Workers")->check(CLI::Range(2, 256))->capture_default_str();
  app.add_flag("--alone", options.alone,
               "One thread does the work of all; what is serial is then free of waking threads");
  app.add_option("--steps", options.steps, "Steps of a scene, at most")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--runs", options.runs, "Runs over the same steps; the shortest time of each task counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--json", options.json, "Also write the figures here");
  CLI11_PARSE(app, argc, argv);

  Json scenes = Json::array();
  for (const std::string& scene : options.scenes) scenes.push_back(balance(scene, options));
  if (!options.json.empty()) {
    write_figures(options.json, "sweepgrid-balance",
                  {{"threads", options.threads}, {"alone", options.alone}, {"runs", options.runs}, {"scenes", scenes}});
  }
  return 0;
}

}  // namespace
}  // namespace sweepgrid::bench

int main(int argc, char** argv) {
  try {
    return sweepgrid::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "balance: " << error.what() << '\n';
    return 2;
  }
}
