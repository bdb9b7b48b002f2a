#include "study/scaling/run.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <sweepgrid/engine/engine.hpp>

#include "cli/overlap_oracle.hpp"
#include "measure/stopwatch.hpp"

namespace sweepgrid::study {
namespace {

constexpr double kNano = 1e-9;
constexpr std::uint32_t kOftenChecked = 200'000;

/// FNV-1a over numbers.
class Checksum {
 public:
  void add(std::uint64_t number) { sum_ = (sum_ ^ number) * 0x100000001b3; }
  template <class Pairs>
  void add_pairs(const Pairs& pairs) {
    add(pairs.size());
    for (const auto& [a, b] : pairs) add(std::uint64_t{a} << 32U | b);
  }
  [[nodiscard]] std::uint64_t sum() const { return sum_; }

 private:
  std::uint64_t sum_ = 0xcbf29ce484222325;
};

template <int Dim>
std::vector<Box<float, Dim>> boxes_of(const std::vector<Box<float, 3>>& boxes) {
  if constexpr (Dim == 3) {
    return boxes;
  } else {
    std::vector<Box<float, Dim>> result(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      std::copy_n(boxes[i].min.begin(), Dim, result[i].min.begin());
      std::copy_n(boxes[i].max.begin(), Dim, result[i].max.begin());
    }
    return result;
  }
}

/// Builds the work graph of one step out of what was recorded of its calls.
class WorkBuilder {
 public:
  explicit WorkBuilder(bool alone) : alone_(alone) {}

  // Loops of a call that took `seconds`; what comes after its last loop is serial and waits for the next one.
  template <class Name>
  void add(const TaskTrace& trace, double seconds, Name&& name) {
    if (trace.empty()) return add_unshared(seconds, name(0));
    std::int64_t until = 0;
    for (std::size_t first = 0; first < trace.size();) {
      std::size_t end = first;
      WorkStage stage;
      stage.name = name(trace[first].stage);
      std::int64_t stage_start = trace[first].start_ns;
      std::int64_t stage_end = 0;
      for (; end < trace.size() && trace[end].stage == trace[first].stage; ++end) {
        stage.tasks.push_back({kNano * static_cast<double>(trace[end].duration_ns), trace[end].size, 0});
        stage_start = std::min(stage_start, trace[end].start_ns);
        stage_end = std::max(stage_end, trace[end].start_ns + trace[end].duration_ns);
      }
      stage.serial =
          std::exchange(serial_, 0) + kNano * static_cast<double>(std::max<std::int64_t>(0, stage_start - until));
      append(std::move(stage));
      until = stage_end;
      first = end;
    }
    serial_ += std::max(0.0, seconds - kNano * static_cast<double>(until));
  }

  WorkGraph finish() {
    WorkStage last;
    last.name = "finish";
    last.serial = serial_;
    append(std::move(last));
    return std::move(graph_);
  }

 private:
  // A call without a loop. Where there is but one worker, that is no sign of its being serial.
  void add_unshared(double seconds, std::string name) {
    WorkStage stage;
    stage.name = std::move(name);
    stage.serial = std::exchange(serial_, 0);
    if (alone_) {
      stage.tasks.push_back({seconds, 0, 0});
    } else {
      stage.serial += seconds;
    }
    append(std::move(stage));
  }

  void append(WorkStage stage) {
    if (!graph_.empty()) stage.after = {static_cast<std::uint32_t>(graph_.size() - 1)};
    graph_.push_back(std::move(stage));
  }

  bool alone_;
  WorkGraph graph_;
  double serial_ = 0;
};

/// One engine on its way through a scene.
template <int Dim>
class EngineRun {
 public:
  using BoxType = Box<float, Dim>;
  using EngineType = Engine<float, Dim, std::uint32_t>;

  EngineRun(const SceneScript& scene, const ScalingSettings& settings, const std::shared_ptr<Executor>& executor,
            RecordingExecutor* recorder)
      : recorder_(recorder), engine_(config(settings, executor)), handles_(scene.objects) {
    run_.stages = engine_.stage_names();
    if (recorder_ != nullptr) {
      engine_.record_tasks(true);
      run_.busy.assign(run_.stages.size(), std::vector<double>(static_cast<std::size_t>(executor->concurrency())));
    }
  }

  // `after(events)` is called after every step.
  template <class After>
  ScalingRun run(const SceneScript& scene, After&& after) {
    for (std::size_t step = 0; step < scene.steps.size(); ++step) {
      do_step(scene.steps[step], step == 0);
      const auto& events = *events_;
      run_.events += events.ends.size() + events.begins.size();
      checksum_.add_pairs(events.ends);
      checksum_.add_pairs(events.begins);
      after(scene.steps[step], events);
    }
    run_.checksum = checksum_.sum();
    return std::move(run_);
  }

 private:
  static Config config(const ScalingSettings& settings, const std::shared_ptr<Executor>& executor) {
    Config config;
    config.cell_population = settings.cell_population;
    config.executor = executor;
    return config;
  }

  void do_step(const ScriptStep& step, bool start) {
    std::vector<Handle> erased;
    std::vector<Handle> updated;
    erased.reserve(step.erased.size());
    updated.reserve(step.updated.size());
    for (const std::uint32_t object : step.erased) erased.push_back(handles_[object]);
    for (const std::uint32_t object : step.updated) updated.push_back(handles_[object]);
    const std::vector<BoxType> inserted_boxes = boxes_of<Dim>(step.inserted_boxes);
    const std::vector<BoxType> updated_boxes = boxes_of<Dim>(step.updated_boxes);

    WorkBuilder work(recorder_ != nullptr && recorder_->concurrency() == 1);
    ScalingTimes times;
    run_.last_step.clear();
    call(work, times, "erase", erased.size(), [&] { engine_.erase(std::span<const Handle>(erased)); });
    std::vector<Handle> inserted;
    call(work, times, "insert", step.inserted.size(), [&] {
      inserted =
          engine_.insert(std::span<const std::uint32_t>(step.inserted), std::span<const BoxType>(inserted_boxes));
    });
    call(work, times, "update", updated.size(),
         [&] { engine_.update(std::span<const Handle>(updated), std::span<const BoxType>(updated_boxes)); });
    const WallStopwatch watch;
    const std::int64_t began = recorder_ != nullptr ? recorder_->now() : 0;
    events_ = &engine_.step();
    times.step = recorder_ != nullptr ? kNano * static_cast<double>(recorder_->since(began)) : watch.seconds();
    for (std::size_t i = 0; i < inserted.size(); ++i) handles_[step.inserted[i]] = inserted[i];
    if (start) return;
    for (const StageTime& stage : engine_.stats().stages) times.stages.push_back(stage.seconds);
    run_.steps.push_back(std::move(times));
    if (recorder_ == nullptr) return;
    const ScalingTimes& taken = run_.steps.back();
    record(work, engine_.tasks(), taken.queueing, taken.step, [&](std::uint32_t stage) { return run_.stages[stage]; });
    run_.work.push_back(work.finish());
    for (const TaskRecord& task : engine_.tasks()) {
      run_.busy[task.stage][static_cast<std::size_t>(task.worker)] += kNano * static_cast<double>(task.duration_ns);
    }
  }

  // Times a bulk call, and records its loops.
  template <class Call>
  void call(WorkBuilder& work, ScalingTimes& times, const char* name, std::size_t items, Call&& call) {
    if (items == 0) return;
    if (recorder_ != nullptr) recorder_->start();
    const WallStopwatch watch;
    const std::int64_t began = recorder_ != nullptr ? recorder_->now() : 0;
    call();
    const double seconds =
        recorder_ != nullptr ? kNano * static_cast<double>(recorder_->since(began)) : watch.seconds();
    if (recorder_ != nullptr) {
      record(work, recorder_->stop(), times.queueing, seconds, [&](std::uint32_t) { return name; });
    }
    times.queueing += seconds;
  }

  // The loops of a call that began `start` seconds into the step and took `seconds`.
  template <class Name>
  void record(WorkBuilder& work, const TaskTrace& trace, double start, double seconds, Name&& name) {
    work.add(trace, seconds, name);
    for (const TaskRecord& task : trace) {
      run_.last_step.push_back({name(task.stage), task.worker, start + kNano * static_cast<double>(task.start_ns),
                                kNano * static_cast<double>(task.duration_ns)});
    }
  }

  RecordingExecutor* recorder_;
  EngineType engine_;
  std::vector<Handle> handles_;  // by object number
  const Events<std::uint32_t>* events_ = nullptr;
  Checksum checksum_;
  ScalingRun run_;
};

template <class After>
ScalingRun run_with(const SceneScript& scene, const ScalingSettings& settings,
                    const std::shared_ptr<Executor>& executor, RecordingExecutor* recorder, After&& after) {
  if (scene.info.dim == 2) return EngineRun<2>(scene, settings, executor, recorder).run(scene, after);
  return EngineRun<3>(scene, settings, executor, recorder).run(scene, after);
}

// The pairs that events lead to, sorted.
void apply_events(std::vector<ScenePair>& pairs, const Events<std::uint32_t>& events) {
  const auto wide = [](const std::vector<Pair<std::uint32_t>>& list) {
    std::vector<ScenePair> result;
    result.reserve(list.size());
    for (const auto& [a, b] : list) result.push_back({a, b});
    return result;
  };
  std::vector<ScenePair> left;
  const std::vector<ScenePair> ends = wide(events.ends);
  const std::vector<ScenePair> begins = wide(events.begins);
  std::set_difference(pairs.begin(), pairs.end(), ends.begin(), ends.end(), std::back_inserter(left), ScenePairOrder());
  pairs.clear();
  std::merge(left.begin(), left.end(), begins.begin(), begins.end(), std::back_inserter(pairs), ScenePairOrder());
}

// By step.
std::vector<std::vector<double>> least_parts(const std::vector<ScalingRun>& runs) {
  std::vector<std::vector<double>> least;
  for (const ScalingRun& run : runs) {
    least.resize(run.steps.size());
    for (std::size_t step = 0; step < run.steps.size(); ++step) {
      const std::vector<double> parts = run.steps[step].parts();
      if (least[step].empty()) least[step] = parts;
      for (std::size_t i = 0; i < parts.size(); ++i) least[step][i] = std::min(least[step][i], parts[i]);
    }
  }
  return least;
}

}  // namespace

std::vector<double> ScalingTimes::parts() const {
  std::vector<double> parts = {queueing};
  double beside = step;
  for (const double stage : stages) {
    parts.push_back(stage);
    beside -= stage;
  }
  parts.push_back(std::max(0.0, beside));
  return parts;
}

ScalingRun run_scaling(const SceneScript& scene, const ScalingSettings& settings,
                       const std::shared_ptr<Executor>& executor, RecordingExecutor* recorder) {
  return run_with(scene, settings, executor, recorder, [](const ScriptStep&, const auto&) {});
}

std::vector<WorkGraph> record_work(const SceneScript& scene, const ScalingSettings& settings, int workers, int runs) {
  std::vector<WorkGraph> least;
  for (int run = 0; run < runs; ++run) {
    const auto recorder = std::make_shared<RecordingExecutor>(make_serial_executor(), workers, RecordingClock::kThread);
    ScalingRun recorded = run_scaling(scene, settings, recorder, recorder.get());
    if (run == 0) {
      least = std::move(recorded.work);
    } else {
      keep_least(least, recorded.work);
    }
  }
  return least;
}

void keep_least(std::vector<WorkGraph>& least, const std::vector<WorkGraph>& other) {
  const auto require = [](bool same) {
    if (!same) throw std::runtime_error("the tasks of a step differ from run to run");
  };
  require(least.size() == other.size());
  for (std::size_t step = 0; step < least.size(); ++step) {
    require(least[step].size() == other[step].size());
    for (std::size_t s = 0; s < least[step].size(); ++s) {
      WorkStage& stage = least[step][s];
      const WorkStage& added = other[step][s];
      require(stage.name == added.name && stage.tasks.size() == added.tasks.size());
      stage.serial = std::min(stage.serial, added.serial);
      for (std::size_t i = 0; i < stage.tasks.size(); ++i) {
        require(stage.tasks[i].size == added.tasks[i].size);
        stage.tasks[i].seconds = std::min(stage.tasks[i].seconds, added.tasks[i].seconds);
      }
    }
  }
}

std::vector<double> least_step_seconds(const std::vector<ScalingRun>& runs) {
  std::vector<double> seconds;
  for (const std::vector<double>& parts : least_parts(runs)) {
    seconds.push_back(std::accumulate(parts.begin(), parts.end(), 0.0));
  }
  return seconds;
}

std::vector<double> least_part_seconds(const std::vector<ScalingRun>& runs) {
  std::vector<double> seconds;
  for (const std::vector<double>& parts : least_parts(runs)) {
    seconds.resize(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) seconds[i] += parts[i];
  }
  return seconds;
}

ScalingCheck check_scaling(const SceneScript& scene) {
  ScalingCheck check;
  OverlapOracle oracle;
  std::vector<ScenePair> pairs;
  std::size_t step = 0;
  const auto after = [&](const ScriptStep& ops, const Events<std::uint32_t>& events) {
    oracle.apply(scene_step(ops));
    apply_events(pairs, events);
    const bool due = scene.objects <= kOftenChecked || step == 0 || step + 1 == scene.steps.size();
    if (due && check.ok) {
      check.ok = pairs == oracle.pairs();
      if (!check.ok) check.error = fmt::format("the pairs after step {} are not those of the oracle", step);
      ++check.steps_checked;
      check.pairs += pairs.size();
    }
    ++step;
  };
  check.checksum = run_with(scene, {}, make_serial_executor(), nullptr, after).checksum;
  return check;
}

}  // namespace sweepgrid::study
