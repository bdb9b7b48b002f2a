#include "study/scaling/scaling_study.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/output_file.hpp"
#include "cli/output_place.hpp"
#include "cli/standard_streams.hpp"
#include "study/report_files.hpp"
#include "study/scaling/findings.hpp"
#include "study/scaling/scene_section.hpp"
#include "study/trace_events.hpp"

namespace sweepgrid::study {
namespace {

constexpr double kMilli = 1e3;
constexpr double kPercent = 100;
constexpr int kTraceWorkers = 64;

Cell number(double value, int digits) { return {fmt::format("{:.{}f}", value, digits), value}; }
Cell text(std::string value) { return {std::move(value), std::nullopt}; }

Table validation_table(const std::vector<SceneFindings>& scenes) {
  Table table;
  table.id = "scaling-validation";
  table.title = "The simulator against this machine";
  table.caption =
      "Milliseconds per step, the least of each part over the rounds on both sides; measured rounds as they were span "
      "from least to most. Simulated: from one thread's recording, with the costs and the memory of this machine. "
      "Replayed: "
      "the tasks with the times that they took on these threads, which shows the schedule by itself. Slowdown: those "
      "times against one thread's; data that another core has changed take longer to get.";
  table.columns = {"scene",     "threads", "measured", "least round",       "most",
                   "simulated", "error %", "replayed", "error of replay %", "slowdown of tasks"};
  for (const SceneFindings& scene : scenes) {
    const auto steps = static_cast<double>(scene.steps);
    for (const MeasuredThreads& run : scene.measured) {
      const auto [least, most] = std::minmax_element(run.round_seconds.begin(), run.round_seconds.end());
      table.rows.push_back({text(scene.name), number(run.threads, 0), number(kMilli * run.seconds / steps, 3),
                            number(kMilli * *least / steps, 3), number(kMilli * *most / steps, 3),
                            number(kMilli * run.predicted_seconds() / steps, 3), number(kPercent * run.error(), 1),
                            number(kMilli * run.replayed.seconds("stealing") / steps, 3),
                            number(kPercent * run.replay_error(), 1), number(run.task_slowdown(), 2)});
    }
  }
  return table;
}

Table exactness_table(const std::vector<SceneFindings>& scenes) {
  Table table;
  table.id = "scaling-exactness";
  table.title = "Exactness";
  table.caption =
      "Every run is the same stream of events, by its checksum; and the pairs that the events lead to are those that a "
      "sort and a sweep find in the boxes: after every step, above 200000 objects after the start and the last one.";
  table.columns = {"scene", "events", "checksum", "runs alike", "checked after steps", "pairs compared", "verdict"};
  for (const SceneFindings& scene : scenes) {
    const bool alike =
        std::all_of(scene.measured.begin(), scene.measured.end(), [](const auto& run) { return run.same_events; });
    table.rows.push_back({text(scene.name), number(static_cast<double>(scene.events), 0),
                          text(fmt::format("{:016x}", scene.checksum)), text(alike ? "yes" : "NO"),
                          number(static_cast<double>(scene.steps_checked), 0),
                          number(static_cast<double>(scene.pairs_checked), 0),
                          text(scene.exact() ? "exact"
                               : scene.ok    ? "THREADS DIFFER"
                                             : scene.error)});
  }
  return table;
}

Table costs_table(const MachineCosts& costs) {
  Table table;
  table.id = "scaling-costs";
  table.title = "What this machine charges for going parallel";
  table.caption = "By micro-benchmarks of the executor and of memory; 0 where other programs left no moment for them.";
  table.columns = {"cost", "value", "least", "most", "unit"};
  const auto row = [&](const char* name, const Spread& figure, double factor, const char* unit) {
    table.rows.push_back({text(name), number(factor * figure.median, 3), number(factor * figure.low, 3),
                          number(factor * figure.high, 3), text(unit)});
  };
  constexpr double kNsPerSecond = 1e9;
  constexpr double kMicro = 1e6;
  row("spawn a task", costs.spawn, kNsPerSecond, "ns");
  row("steal", costs.steal, kMicro, "us");
  row("wake a worker", costs.wake, kMicro, "us");
  row("a worker sleeps after", costs.spin, kMicro, "us");
  row("barrier between stages", costs.barrier, kMicro, "us");
  row("memory copied by one thread", costs.stream, 1e-9, "GB/s");
  row(fmt::format("memory roof: {} threads against one", costs.threads).c_str(), costs.roof, 1, "times");
  row(fmt::format("arithmetic: {} threads against one", costs.threads).c_str(), costs.cores, 1, "times");
  return table;
}

Table memory_table(const std::vector<SceneFindings>& scenes) {
  Table table;
  table.id = "scaling-memory";
  table.title = "Bound by memory";
  table.caption =
      "Share of a stage's time that is bound by the bandwidth of memory, by how much slower it is beside a thread that "
      "does nothing but copy.";
  table.columns = {"scene", "stage", "share %"};
  for (const SceneFindings& scene : scenes) {
    for (const auto& [stage, share] : scene.memory) {
      table.rows.push_back({text(scene.name), text(stage), number(kPercent * share, 0)});
    }
  }
  return table;
}

std::string command(const ScalingOptions& options) {
  std::string text = fmt::format("sweepgrid study scaling {}", fmt::join(options.scenes, " "));
  if (!options.threads.empty()) text += fmt::format(" --threads {}", fmt::join(options.threads, ","));
  if (!options.simulate.empty()) text += fmt::format(" --simulate {}", fmt::join(options.simulate, ","));
  if (options.weak) text += " --weak";
  if (options.study.quick) text += " --quick";
  return text;
}

Report make_report(const ScalingOptions& options, const std::vector<SceneFindings>& scenes, const MachineCosts& costs) {
  Report report;
  report.study = "scaling";
  report.title = "How steps scale with threads";
  report.command = command(options);
  double worst = 0;
  double worst_replay = 0;
  for (const SceneFindings& scene : scenes) {
    for (const MeasuredThreads& run : scene.measured) {
      worst = std::max(worst, std::abs(run.error()));
      worst_replay = std::max(worst_replay, std::abs(run.replay_error()));
    }
  }
  const bool exact = std::all_of(scenes.begin(), scenes.end(), [](const auto& scene) { return scene.exact(); });
  report.summary = fmt::format(
      "Measured with the threads that this machine has, and simulated with more: the recorded tasks of every step, cut "
      "for so many workers, replayed under several policies with what this machine charges. The simulator is at most "
      "{:.1f} % off the measured steps, and {:.1f} % where it replays tasks with the times that they took on as many "
      "threads: what lies between is that tasks get slower beside others. {}",
      kPercent * worst, kPercent * worst_replay,
      exact ? "All runs led to exactly the right events." : "SOME RUNS LED TO WRONG EVENTS.");
  Section& overview = report.sections.emplace_back();
  overview.title = "All scenes";
  overview.text =
      "Everything called simulated is a prediction. It takes the times of tasks from one thread that did the work of "
      "all, so it knows nothing of caches that workers share, nor of processors of different speed.";
  overview.tables = {validation_table(scenes), exactness_table(scenes), costs_table(costs), memory_table(scenes)};
  for (std::size_t i = 0; i < scenes.size(); ++i) report.sections.push_back(scene_section(scenes[i], i));
  return report;
}

void print_summary(std::FILE* out, const std::vector<SceneFindings>& scenes) {
  for (const SceneFindings& scene : scenes) {
    fmt::print(out, "{}\n", scene.name);
    const auto steps = static_cast<double>(scene.steps);
    for (const MeasuredThreads& run : scene.measured) {
      fmt::print(
          out,
          "  {:>3} threads  measured {:9.3f} ms, speed-up {:5.2f}; simulated {:9.3f} ms, {:+.1f} %, replayed {:+.1f} "
          "%\n",
          run.threads, kMilli * run.seconds / steps, scene.measured.front().seconds / run.seconds,
          kMilli * run.predicted_seconds() / steps, kPercent * run.error(), kPercent * run.replay_error());
    }
    for (const auto& [workers, prediction] : scene.predicted) {
      fmt::print(out, "  {:>3} workers  simulated:", workers);
      for (const Forecast& forecast : kForecasts) {
        fmt::print(out, " {} {:.1f}{}", forecast.name, scene.predicted_speedup(workers, forecast.id),
                   &forecast == &kForecasts.back() ? "\n" : ",");
      }
    }
    fmt::print(out, "  {}\n", scene.exact() ? "exact" : "NOT EXACT");
  }
}

// The last step of the first scene: as it ran on all threads, and as it is simulated.
void write_trace(OutputFile& file, const ScalingPlan& plan, ScalingBench& bench) {
  const std::string& scene = plan.scenes.front();
  const auto lanes = [](int workers) {
    std::vector<std::string> names;
    names.reserve(static_cast<std::size_t>(workers));
    for (int w = 0; w < workers; ++w) names.push_back(fmt::format("worker {}", w));
    return names;
  };
  TraceProcess measured{
      fmt::format("{}, measured, {} threads", scene, plan.threads.back()), lanes(plan.threads.back()), {}};
  const auto recorder = std::make_shared<RecordingExecutor>(make_executor(plan.threads.back()));
  for (const RanTask& task : run_scaling(bench.scene(scene), {}, recorder, recorder.get()).last_step) {
    measured.slices.push_back(
        {static_cast<std::size_t>(task.worker), task.stage, "measured", task.start, task.duration});
  }
  TraceProcess simulated{fmt::format("{}, simulated, {} workers", scene, kTraceWorkers), lanes(kTraceWorkers), {}};
  const ScalingBench::Timed timed = bench.timed_step(scene, kTraceWorkers);
  for (const ScheduledTask& task : timed.schedule.tasks) {
    const bool serial = task.task == ScheduledTask::kSerialPart;
    if (task.duration <= 0) continue;
    simulated.slices.push_back({task.worker, timed.work[task.stage].name + (serial ? ", serial" : ""), "simulated",
                                task.start, task.duration});
  }
  file.write(trace_events({measured, simulated}));
  file.commit();
}

}  // namespace

std::vector<std::string> scaling_scenes() {
  return {"uniform:n=100000,moving=1,churn=0", "uniform:n=100000,moving=0.1,churn=0.005",
          "clusters:n=100000,moving=1,churn=0", "sizes:n=50000,moving=1,churn=0", "pile:n=100000,moving=1,churn=0"};
}

bool scaling_study(const ScalingOptions& options) {
  const std::filesystem::path folder = make_out_folder(options.study);
  check_study_files("scaling", folder, options.scenes, {"--trace", options.trace});
  const ScalingPlan plan = ScalingPlan::of(options);
  // Opened before the work, so that a path that cannot be written to costs none.
  std::optional<OutputFile> trace;
  if (!options.trace.empty()) trace.emplace(options.trace);
  PointStore store(folder, Fingerprint::here("scaling", plan.parameters()), options.study.points);
  for (const std::string& note : store.notes()) show_on_stderr(fmt::format("{}\n", note));
  ScalingBench bench(plan, store);
  measure_points("study scaling", bench.points(), store);
  const std::vector<SceneFindings> scenes = scaling_findings(plan, store);
  const Report report = make_report(options, scenes, store.get<MachineCosts>(scaling_key::kCosts));
  const ReportFiles files = write_report(report, folder);
  if (trace) write_trace(*trace, plan, bench);
  std::FILE* const for_people = is_standard_output(options.trace) ? stderr : stdout;
  print_summary(for_people, scenes);
  fmt::print(for_people, "{}\n", files.html.empty() ? files.json.string() : files.html.string());
  return std::all_of(scenes.begin(), scenes.end(), [](const SceneFindings& scene) { return scene.exact(); });
}

}  // namespace sweepgrid::study
