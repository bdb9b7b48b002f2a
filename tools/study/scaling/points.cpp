#include "study/scaling/points.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include <sweepgrid/scheduler/executor.hpp>

#include "cli/machine_info.hpp"
#include "scenes/generator_params.hpp"
#include "study/scaling/what_if.hpp"

namespace sweepgrid::study {
namespace {

using Json = nlohmann::json;

constexpr int kTimelineWorkers = 16;

std::vector<int> doubling(int most) {
  std::vector<int> numbers;
  for (int number = 1; number < most; number *= 2) numbers.push_back(number);
  numbers.push_back(most);
  return numbers;
}

// Ascending, each once, with one worker to compare with.
std::vector<int> tidy(std::vector<int> numbers) {
  numbers.push_back(1);
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

/// Copies memory on another thread as long as it lives.
class MemoryHog {
 public:
  MemoryHog()
      : from_(kBytes, 1), to_(kBytes, 2), thread_([this](const std::stop_token& stop) {
          for (std::size_t at = 0; !stop.stop_requested(); at = (at + kSlice) % kBytes) {
            std::memcpy(&to_[at], &from_[at], kSlice);
          }
        }) {}

 private:
  static constexpr std::size_t kSlice = std::size_t{1} << 20;
  static constexpr std::size_t kBytes = 64 * kSlice;
  std::vector<char> from_;
  std::vector<char> to_;
  std::jthread thread_;
};

// The share of memory in a stage that takes `slower` times as long beside a thread that does nothing but copy, where
// `roof` such threads could run at full speed: the inverse of what the simulator does.
double memory_share(double slower, double roof) {
  const auto predicted = [&](double share) { return 1 - share + share * std::max(1.0, (1 + share) / roof); };
  if (slower >= predicted(1)) return predicted(1) > 1 ? 1 : 0;
  double low = 0;
  double high = 1;
  for (int i = 0; i < 50; ++i) (predicted((low + high) / 2) < slower ? low : high) = (low + high) / 2;
  return slower <= 1 ? 0 : low;
}

std::map<std::string, double> work_by_stage(const std::vector<WorkGraph>& steps) {
  std::map<std::string, double> work;
  for (const WorkGraph& step : steps) {
    for (const WorkStage& stage : step) {
      for (const WorkTask& task : stage.tasks) work[stage.name] += task.seconds;
    }
  }
  return work;
}

}  // namespace

ScalingPlan ScalingPlan::of(const ScalingOptions& options) {
  ScalingPlan plan;
  plan.scenes = options.scenes.empty() ? scaling_scenes() : options.scenes;
  const auto cores = static_cast<int>(std::max(1U, machine_info().cores));
  plan.threads = tidy(options.threads.empty() ? doubling(cores) : options.threads);
  if (plan.threads.back() > cores) {
    throw std::invalid_argument(
        fmt::format("--threads {}: this machine has {}; --simulate predicts more", plan.threads.back(), cores));
  }
  plan.simulate = tidy(options.simulate.empty() ? doubling(256) : options.simulate);
  plan.weak = options.weak;
  for (const std::string& scene : plan.scenes) {
    if (plan.weak) static_cast<void>(grown_scene(scene, 1));  // refuses recordings before anything is measured
  }
  if (options.study.quick) {
    plan.steps = 4;
    plan.rounds = 3;
    plan.runs = 2;
    plan.populations = {8, 32};
    if (options.simulate.empty()) plan.simulate = {1, 2, 8, 64, 256};
    plan.weak_objects = 200'000;
  }
  return plan;
}

Json ScalingPlan::parameters() const {
  return {{"steps", steps}, {"rounds", rounds}, {"runs", runs}, {"threads", threads}, {"weak_objects", weak_objects}};
}

namespace scaling_key {
std::string memory(const std::string& scene) { return scene + ": memory"; }
std::string measured(const std::string& scene) { return scene + ": measured"; }
std::string checked(const std::string& scene) { return scene + ": checked"; }
std::string predicted(const std::string& scene, int workers) { return fmt::format("{}: {} workers", scene, workers); }
std::string population(const std::string& scene, int population) {
  return fmt::format("{}: {} objects per cell", scene, population);
}
std::string cut(const std::string& scene) { return scene + ": grain and shards"; }
std::string timeline(const std::string& scene) { return scene + ": timeline"; }
std::string weak(const std::string& scene, int workers) { return fmt::format("{}: grown {} times", scene, workers); }
}  // namespace scaling_key

std::vector<StudyPoint> ScalingBench::points() {
  std::vector<StudyPoint> points;
  const auto add = [&](std::string key, double cost, std::function<Json()> measure) {
    points.push_back({std::move(key), cost, std::move(measure)});
  };
  add(scaling_key::kCosts, 3, [] { return Json(measure_machine_costs()); });
  for (const std::string& name : plan_.scenes) {
    add(scaling_key::memory(name), 2, [this, name] { return memory_shares(name); });
    add(scaling_key::measured(name), plan_.rounds, [this, name] { return measured(name); });
    add(scaling_key::checked(name), 3, [this, name] { return checked(name); });
    for (const int workers : plan_.simulate) {
      add(scaling_key::predicted(name, workers), 1, [this, name, workers] { return predicted(name, workers, {}); });
    }
    for (const int population : plan_.populations) {
      add(scaling_key::population(name, population), 1, [this, name, population] {
        ScalingSettings settings;
        settings.cell_population = population;
        return predicted(name, plan_.what_if_workers, settings);
      });
    }
    add(scaling_key::cut(name), 4, [this, name] { return cut(name); });
    add(scaling_key::timeline(name), 1, [this, name] { return timeline(name); });
    if (!plan_.weak) continue;
    for (const int workers : plan_.weak_workers(name)) {
      add(scaling_key::weak(name, workers), workers, [this, name, workers] { return weak(name, workers); });
    }
  }
  return points;
}

std::vector<int> ScalingPlan::weak_workers(const std::string& scene) const {
  std::vector<int> result = threads;
  const std::uint64_t objects = parse_generator(scene)->n;
  for (const int workers : simulate) {
    if (objects * static_cast<std::uint64_t>(workers) <= weak_objects) result.push_back(workers);
  }
  return tidy(std::move(result));
}

const SceneScript& ScalingBench::scene(const std::string& name) {
  if (scene_.scene != name) scene_ = read_scaling_scene(name, plan_.steps);
  return scene_;
}

MachineCosts ScalingBench::costs() const { return store_.get<MachineCosts>(scaling_key::kCosts); }

MemoryShares ScalingBench::shares(const std::string& scene) const {
  return store_.read(scaling_key::memory(scene),
                     [](const Json& point) { return member_of<MemoryShares>(point, "shares"); });
}

// One thread works alone and beside one that copies memory, in turn; medians, because both are about what is shared.
Json ScalingBench::memory_shares(const std::string& name) {
  const double roof = costs().schedule_costs(true).memory_roof;
  std::map<std::string, std::vector<double>> slower;
  for (int round = 0; round < plan_.rounds; ++round) {
    const auto alone = work_by_stage(record_work(scene(name), {}, 1, 1));
    const MemoryHog hog;
    for (const auto& [stage, seconds] : work_by_stage(record_work(scene(name), {}, 1, 1))) {
      if (alone.at(stage) > 0) slower[stage].push_back(seconds / alone.at(stage));
    }
  }
  Json shares = Json::object();
  Json spreads = Json::object();
  for (const auto& [stage, ratios] : slower) {
    const Spread ratio = spread(ratios);
    shares[stage] = memory_share(ratio.median, roof);
    spreads[stage] = {{"median", ratio.median}, {"low", ratio.low}, {"high", ratio.high}};
  }
  return {{"shares", shares}, {"slower", spreads}};
}

// Runs with every number of threads, and recorded ones that are cut for them, take turns.
Json ScalingBench::measured(const std::string& name) {
  const SceneScript& played = scene(name);
  std::map<int, std::vector<ScalingRun>> runs;
  std::map<int, std::vector<WorkGraph>> work;    // by one thread that passes for so many
  std::map<int, std::vector<WorkGraph>> as_ran;  // by as many threads
  std::map<int, ScalingRun> traced;
  const auto keep = [](std::vector<WorkGraph>& least, std::vector<WorkGraph> recorded) {
    if (least.empty()) {
      least = std::move(recorded);
    } else {
      keep_least(least, recorded);
    }
  };
  for (int round = 0; round < plan_.rounds; ++round) {
    for (const int threads : plan_.threads) {
      runs[threads].push_back(run_scaling(played, {}, make_executor(threads), nullptr));
      keep(work[threads], record_work(played, {}, threads, 1));
      const auto recorder = std::make_shared<RecordingExecutor>(make_executor(threads));
      traced[threads] = run_scaling(played, {}, recorder, recorder.get());
      keep(as_ran[threads], traced[threads].work);
    }
  }
  Json by_threads = Json::array();
  for (const int threads : plan_.threads) {
    std::vector<double> round_seconds;
    std::vector<std::uint64_t> checksums = {traced[threads].checksum};
    for (const ScalingRun& run : runs[threads]) {
      double seconds = 0;
      for (const ScalingTimes& step : run.steps) seconds += step.queueing + step.step;
      round_seconds.push_back(seconds);
      checksums.push_back(run.checksum);
    }
    const std::vector<double> parts = least_part_seconds(runs[threads]);
    by_threads.push_back({{"threads", threads},
                          {"step_s", least_step_seconds(runs[threads])},
                          {"part_s", parts},
                          {"round_s", round_seconds},
                          {"busy_s", traced[threads].busy},
                          {"checksums", checksums},
                          {"predicted", predict(work[threads], threads, costs(), shares(name))},
                          {"replayed", predict(as_ran[threads], threads, costs(), {})}});
  }
  const ScalingRun& first = runs.begin()->second.front();
  return {{"stages", first.stages},
          {"steps", first.steps.size()},
          {"events", first.events},
          {"objects", played.objects},
          {"runs", by_threads}};
}

Json ScalingBench::checked(const std::string& name) {
  const ScalingCheck check = check_scaling(scene(name));
  return {{"ok", check.ok},
          {"error", check.error},
          {"checksum", check.checksum},
          {"steps_checked", check.steps_checked},
          {"pairs", check.pairs}};
}

Json ScalingBench::predicted(const std::string& name, int workers, const ScalingSettings& settings) {
  return predict(record_work(scene(name), settings, workers, plan_.runs), workers, costs(), shares(name));
}

Json ScalingBench::cut(const std::string& name) {
  Json variants = Json::array();
  for (const CutVariant& variant : cut_variants(scene(name), plan_.what_if_workers, plan_.runs)) {
    const Prediction prediction = predict(variant.steps, plan_.what_if_workers, costs(), shares(name));
    variants.push_back({{"what", variant.what}, {"factor", variant.factor}, {"predicted", prediction}});
  }
  return variants;
}

ScalingBench::Timed ScalingBench::timed_step(const std::string& name, int workers) {
  std::vector<WorkGraph> steps = record_work(scene(name), {}, workers, plan_.runs);
  Timed timed;
  timed.work = std::move(steps.back());
  timed.schedule = simulate(timed.work, workers, SchedulePolicy::kWorkStealing, costs().schedule_costs(false));
  return timed;
}

Json ScalingBench::timeline(const std::string& name) {
  const Timed timed = timed_step(name, kTimelineWorkers);
  Json stages = Json::array();
  for (const WorkStage& stage : timed.work) stages.push_back(stage.name);
  Json tasks = Json::array();
  for (const ScheduledTask& task : timed.schedule.tasks) {
    tasks.push_back({task.worker, task.stage,
                     task.task == ScheduledTask::kSerialPart ? -1 : static_cast<int>(task.task), task.start,
                     task.duration});
  }
  return {{"workers", kTimelineWorkers}, {"stages", stages}, {"tasks", tasks}};
}

Json ScalingBench::weak(const std::string& name, int workers) {
  const SceneScript grown = read_scaling_scene(grown_scene(name, static_cast<std::uint64_t>(workers)), plan_.steps);
  Json result = {{"workers", workers}, {"objects", grown.objects}};
  if (std::binary_search(plan_.threads.begin(), plan_.threads.end(), workers)) {
    std::vector<ScalingRun> runs;
    runs.reserve(static_cast<std::size_t>(plan_.rounds));
    for (int round = 0; round < plan_.rounds; ++round) {
      runs.push_back(run_scaling(grown, {}, make_executor(workers), nullptr));
    }
    result["step_s"] = least_step_seconds(runs);
  }
  result["predicted"] = predict(record_work(grown, {}, workers, plan_.runs), workers, costs(), shares(name));
  return result;
}

}  // namespace sweepgrid::study
