#include "study/scaling/scene_section.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "measure/in_turn.hpp"

namespace sweepgrid::study {
namespace {

constexpr double kMsPerSecond = 1e3;
constexpr double kPercentOfOne = 100;

Cell number_cell(double value, int digits) { return {fmt::format("{:.{}f}", value, digits), value}; }
Cell whole(double value) { return {fmt::format("{:.0f}", value), value}; }
Cell text_cell(std::string value) { return {std::move(value), std::nullopt}; }

std::string id(const char* what, std::size_t index) { return fmt::format("scaling-{}-{}", what, index + 1); }

// Against one thread, round by round.
Point measured_speedup(const MeasuredThreads& one, const MeasuredThreads& run) {
  Point point{static_cast<double>(run.threads), one.seconds / run.seconds, {}, {}, {}};
  const std::vector<double> by_round = ratios(one.round_seconds, run.round_seconds);
  point.low = std::min(point.y, *std::min_element(by_round.begin(), by_round.end()));
  point.high = std::max(point.y, *std::max_element(by_round.begin(), by_round.end()));
  return point;
}

// The spread is over the steps.
Point predicted_speedup(const SceneFindings& scene, int workers, const Forecast& forecast) {
  const std::vector<double>& one = scene.predicted.at(1).step_seconds.at(forecast.id);
  const std::vector<double>& many = scene.predicted.at(workers).step_seconds.at(forecast.id);
  const std::vector<double> by_step = ratios(one, many);
  return {static_cast<double>(workers),
          scene.predicted_speedup(workers, forecast.id),
          *std::min_element(by_step.begin(), by_step.end()),
          *std::max_element(by_step.begin(), by_step.end()),
          {}};
}

LineChart speedup_chart(const SceneFindings& scene, std::size_t index) {
  LineChart chart;
  chart.id = id("speedup", index);
  chart.title = "Speed-up";
  chart.caption =
      "Whole steps, queueing included, against one thread. Measured bars span the rounds, simulated ones the steps. "
      "The "
      "bound is min(P, work / span) of the tasks recorded for P workers.";
  chart.x = {"workers", "", true};
  chart.y = {"speed-up", "", true};
  Series measured{"measured", SeriesStyle::kMeasured, {}};
  for (const MeasuredThreads& run : scene.measured) {
    measured.points.push_back(measured_speedup(scene.measured.front(), run));
  }
  chart.series.push_back(std::move(measured));
  for (const Forecast& forecast : kForecasts) {
    Series series{forecast.name, SeriesStyle::kSimulated, {}};
    for (const auto& [workers, prediction] : scene.predicted) {
      series.points.push_back(predicted_speedup(scene, workers, forecast));
    }
    chart.series.push_back(std::move(series));
  }
  Series bound{"bound by work and span", SeriesStyle::kFitted, {}};
  for (const auto& [workers, prediction] : scene.predicted) {
    bound.points.push_back(
        {static_cast<double>(workers), std::min<double>(workers, prediction.work / prediction.span), {}, {}, {}});
  }
  chart.series.push_back(std::move(bound));
  return chart;
}

LineChart stages_chart(const SceneFindings& scene, std::size_t index) {
  LineChart chart;
  chart.id = id("stages", index);
  chart.title = "Time of the stages";
  chart.caption =
      "Wall time per step of each stage with its plan, simulated with work stealing. erase, insert and update are the "
      "bulk calls before step(); finish is what follows the last stage.";
  chart.x = {"workers", "", true};
  chart.y = {"time per step", "ms", true};
  for (const auto& [workers, prediction] : scene.predicted) {
    for (const StageForecast& stage : prediction.stages) {
      auto series = std::find_if(chart.series.begin(), chart.series.end(),
                                 [&](const Series& known) { return known.name == stage.name; });
      if (series == chart.series.end()) {
        series = chart.series.insert(series, {stage.name, SeriesStyle::kSimulated, {}});
      }
      if (stage.wall <= 0) continue;
      series->points.push_back({static_cast<double>(workers),
                                kMsPerSecond * stage.wall / static_cast<double>(scene.steps),
                                {},
                                {},
                                fmt::format("{:.0f} tasks", stage.tasks)});
    }
  }
  std::erase_if(chart.series, [](const Series& series) { return series.points.empty(); });
  return chart;
}

Table measured_table(const SceneFindings& scene, std::size_t index) {
  Table table;
  table.id = id("measured", index);
  table.title = "Measured";
  table.caption =
      "Per step: the least time of each part of a step over the rounds, added up; the spread is that of whole rounds. "
      "Balance: mean over most of the workers' times in tasks. Serial by Amdahl: the share that explains the speed-up "
      "(Karp and Flatt); by the graph: serial parts of the recorded work.";
  table.columns = {"threads", "ms per step",        "least to most of a round", "speed-up",   "efficiency %",
                   "balance", "serial by Amdahl %", "serial by the graph %",    "queueing ms"};
  for (const std::string& stage : scene.stages) table.columns.push_back(stage + " ms");
  const auto steps = static_cast<double>(scene.steps);
  for (const MeasuredThreads& run : scene.measured) {
    const double speedup = scene.measured.front().seconds / run.seconds;
    const auto [least, most] = std::minmax_element(run.round_seconds.begin(), run.round_seconds.end());
    const double p = run.threads;
    std::vector<Cell> row = {
        whole(p),
        number_cell(kMsPerSecond * run.seconds / steps, 3),
        text_cell(fmt::format("{:.3f} to {:.3f}", kMsPerSecond * *least / steps, kMsPerSecond * *most / steps)),
        number_cell(speedup, 2),
        number_cell(kPercentOfOne * speedup / p, 0),
        number_cell(run.balance(), 3),
        run.threads == 1 ? text_cell("") : number_cell(kPercentOfOne * (p / speedup - 1) / (p - 1), 2),
        number_cell(kPercentOfOne * run.predicted.serial / run.predicted.work, 2)};
    for (std::size_t part = 0; part <= scene.stages.size(); ++part) {
      row.push_back(number_cell(kMsPerSecond * run.part_seconds[part] / steps, 3));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table predicted_table(const SceneFindings& scene, std::size_t index) {
  Table table;
  table.id = id("predicted", index);
  table.title = "Simulated";
  table.caption =
      "Speed-ups by policy against one worker, and what bounds them: the work of the tasks as cut for so many workers, "
      "their span, and the share of serial parts.";
  table.columns = {"workers"};
  for (const Forecast& forecast : kForecasts) table.columns.emplace_back(forecast.name);
  for (const char* column : {"efficiency %", "work / span", "work ms per step", "serial %", "tasks per step"}) {
    table.columns.emplace_back(column);
  }
  const auto steps = static_cast<double>(scene.steps);
  for (const auto& [workers, prediction] : scene.predicted) {
    std::vector<Cell> row = {whole(workers)};
    for (const Forecast& forecast : kForecasts)
      row.push_back(number_cell(scene.predicted_speedup(workers, forecast.id), 2));
    row.push_back(number_cell(kPercentOfOne * scene.predicted_speedup(workers, kForecasts[0].id) / workers, 0));
    row.push_back(number_cell(prediction.work / prediction.span, 1));
    row.push_back(number_cell(kMsPerSecond * prediction.work / steps, 3));
    row.push_back(number_cell(kPercentOfOne * prediction.serial / prediction.work, 2));
    double tasks = 0;
    for (const StageForecast& stage : prediction.stages) tasks += stage.tasks;
    row.push_back(whole(tasks));
    table.rows.push_back(std::move(row));
  }
  return table;
}

// Where the time of all workers goes, of which useful work is the part that one worker would need, too.
Table loss_table(const SceneFindings& scene, std::size_t index) {
  auto chosen = scene.predicted.find(scene.what_if_workers);
  if (chosen == scene.predicted.end()) chosen = std::prev(scene.predicted.end());
  const Prediction& many = chosen->second;
  const Prediction& one = scene.predicted.at(1);
  const double workers = many.workers;
  const double whole_time = workers * many.seconds(kForecasts[0].id);
  Table table;
  table.id = id("loss", index);
  table.title = fmt::format("Where the time of {} simulated workers goes", many.workers);
  table.caption =
      "Per cent of all workers' time. Useful: what the stage takes on one worker. Cutting: what its tasks take beyond "
      "that when there are as many as for so many workers. Serial: the others wait for a plan. Waiting: tasks are too "
      "few or too uneven, and starting, stealing and waking.";
  table.columns = {"stage", "tasks", "longest task ms", "useful %", "cutting %", "serial %", "waiting %", "all %"};
  for (const StageForecast& stage : many.stages) {
    const auto alone = std::find_if(one.stages.begin(), one.stages.end(),
                                    [&](const StageForecast& other) { return other.name == stage.name; });
    const double base = alone == one.stages.end() ? 0 : alone->work + alone->serial;
    const double all = workers * stage.wall;
    const double done = stage.work + stage.serial;
    const double serial = (workers - 1) * stage.serial;
    table.rows.push_back({text_cell(stage.name), whole(stage.tasks),
                          number_cell(kMsPerSecond * stage.longest / static_cast<double>(scene.steps), 4),
                          number_cell(kPercentOfOne * base / whole_time, 2),
                          number_cell(kPercentOfOne * (done - base) / whole_time, 2),
                          number_cell(kPercentOfOne * serial / whole_time, 2),
                          number_cell(kPercentOfOne * (all - serial - done) / whole_time, 2),
                          number_cell(kPercentOfOne * all / whole_time, 2)});
  }
  return table;
}

LineChart what_if_chart(const SceneFindings& scene, std::size_t index, const char* what, const char* title,
                        const char* axis, const char* caption) {
  LineChart chart;
  chart.id = id(what, index);
  chart.title = fmt::format("What if: {}", title);
  chart.caption = caption;
  chart.x = {axis, "", true};
  chart.y = {fmt::format("time per step on {} workers", scene.what_if_workers), "ms", false};
  for (const Forecast& forecast : kForecasts) {
    Series series{forecast.name, SeriesStyle::kSimulated, {}};
    for (const WhatIf& point : scene.what_ifs) {
      if (point.what != what) continue;
      const double seconds = point.predicted.seconds(forecast.id);
      const double speedup = scene.predicted.at(1).seconds(forecast.id) / seconds;
      series.points.push_back({point.value,
                               kMsPerSecond * seconds / static_cast<double>(scene.steps),
                               {},
                               {},
                               fmt::format("speed-up {:.1f} against one worker as it comes", speedup)});
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

LineChart weak_chart(const SceneFindings& scene, std::size_t index) {
  LineChart chart;
  chart.id = id("weak", index);
  chart.title = "Weak scaling";
  chart.caption = "Objects grow with the workers; as fast as one worker with its share of them is 1.";
  chart.x = {"workers", "", true};
  chart.y = {"efficiency", "", false};
  Series measured{"measured", SeriesStyle::kMeasured, {}};
  for (const WeakFindings& run : scene.weak) {
    if (run.measured_seconds <= 0) continue;
    measured.points.push_back({static_cast<double>(run.workers),
                               scene.weak.front().measured_seconds / run.measured_seconds,
                               {},
                               {},
                               fmt::format("{} objects", run.objects)});
  }
  chart.series.push_back(std::move(measured));
  for (const Forecast& forecast : kForecasts) {
    Series series{forecast.name, SeriesStyle::kSimulated, {}};
    const double one = scene.weak.front().predicted.seconds(forecast.id);
    for (const WeakFindings& run : scene.weak) {
      series.points.push_back({static_cast<double>(run.workers),
                               one / run.predicted.seconds(forecast.id),
                               {},
                               {},
                               fmt::format("{} objects", run.objects)});
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

Timeline timeline(const SceneFindings& scene, std::size_t index) {
  const TimelineFindings& found = scene.timeline;
  Timeline result;
  result.id = id("timeline", index);
  result.title = fmt::format("The last step on {} workers, simulated", found.workers);
  result.caption = "Work stealing. Serial parts are groups of their own.";
  result.lanes.reserve(found.workers);
  for (std::size_t w = 0; w < found.workers; ++w) result.lanes.push_back(fmt::format("worker {}", w));
  // Stages of one name, such as the loops of one bulk call, share a colour.
  std::vector<std::string> groups;
  const auto group = [&](const std::string& name) {
    const auto known = std::find(groups.begin(), groups.end(), name);
    if (known != groups.end()) return static_cast<std::size_t>(known - groups.begin());
    groups.push_back(name);
    return groups.size() - 1;
  };
  for (const TimelineFindings::Task& task : found.tasks) {
    if (task.duration <= 0) continue;
    const std::string& stage = found.stages[task.stage];
    const bool serial = task.task < 0;
    result.spans.push_back({task.worker, task.start, task.duration, group(serial ? stage + ", serial" : stage),
                            serial ? stage + ", serial part" : fmt::format("{} task {}", stage, task.task)});
  }
  result.groups = std::move(groups);
  return result;
}

}  // namespace

Section scene_section(const SceneFindings& scene, std::size_t index) {
  Section section;
  section.title = scene.name;
  section.text =
      fmt::format("{} objects, {} steps after the start, {} events. {}", scene.objects, scene.steps, scene.events,
                  scene.exact() ? "The events are the same for every number of threads, and right."
                                : "THE EVENTS ARE NOT RIGHT; see the table of exactness.");
  section.charts.push_back(speedup_chart(scene, index));
  section.charts.push_back(stages_chart(scene, index));
  if (!scene.weak.empty()) section.charts.push_back(weak_chart(scene, index));
  section.charts.push_back(what_if_chart(scene, index, "population", "the size of cells", "objects per cell",
                                         "Cell sizes derived for so many objects in a cell."));
  section.charts.push_back(
      what_if_chart(scene, index, "grain", "the grain of tasks", "grain, 1 as it comes",
                    "Tasks finer by having them cut for more workers, or coarser by taking neighbours together."));
  section.charts.push_back(what_if_chart(scene, index, "shards", "the number of shards", "shards, 1 as they come",
                                         "The stage gather with as many shards as for other numbers of workers."));
  section.timelines.push_back(timeline(scene, index));
  section.tables.push_back(measured_table(scene, index));
  section.tables.push_back(predicted_table(scene, index));
  section.tables.push_back(loss_table(scene, index));
  return section;
}

}  // namespace sweepgrid::study
