#include "report_sample.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace sweepgrid::study {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Point with_spread(double x, double y, double spread) { return {x, y, y * (1 - spread), y * (1 + spread)}; }

LineChart speedup() {
  Series measured = {"uniform 1e6", SeriesStyle::kMeasured, {}};
  for (const double threads : {1, 2, 4}) measured.points.push_back(with_spread(threads, std::pow(threads, 0.95), 0.06));
  Series stealing = {"work stealing", SeriesStyle::kSimulated, {}};
  Series ranges = {"static ranges", SeriesStyle::kSimulated, {}};
  Series ideal = {"ideal", SeriesStyle::kFitted, {}};
  for (double workers = 1; workers <= 256; workers *= 2) {
    stealing.points.push_back({workers, workers / (1 + 0.004 * workers)});
    ranges.points.push_back({workers, workers / (1 + 0.03 * workers)});
    ideal.points.push_back({workers, workers});
  }
  stealing.like = "uniform 1e6";
  return {"speed-up",
          "Speed-up on many workers",
          "A million cubes of which all move. Marks: measured, with the least and most of five repetitions; dashed: "
          "the recorded tasks replayed on so many workers.",
          {"workers", "", true},
          {"speed-up", "", true},
          {measured, stealing, ranges, ideal}};
}

LineChart growth() {
  LineChart chart = {"growth",
                     "Time per step grows as the paper says",
                     "Uniform cubes at 5 % density in one cell, as in Figure 2.",
                     {"objects", "", true},
                     {"time per step", "ms", true},
                     {}};
  const std::vector<std::pair<const char*, double>> systems = {
      {"classic", 1.76}, {"batch", 1.66}, {"segmented", 1.6}, {"grid", 1.02}, {"octree", 1.1}};
  for (std::size_t i = 0; i < systems.size(); ++i) {
    const auto& [name, exponent] = systems[i];
    Series series = {name, SeriesStyle::kMeasured, {}};
    Series fit = {std::string(name) + ", fit", SeriesStyle::kFitted, {}, name};
    for (const double objects : {1e3, 3e3, 1e4, 3e4, 1e5, 2e5}) {
      const double time = 0.05 * static_cast<double>(i + 1) * std::pow(objects / 1e3, exponent);
      series.points.push_back(with_spread(objects, time * (1 + 0.1 * std::sin(objects)), 0.08));
      fit.points.push_back({objects, time});
    }
    chart.series.push_back(series);
    if (i < 2) chart.series.push_back(fit);
  }
  return chart;
}

LineChart gaps() {
  return {
      "gaps",
      std::string("Numbers that are none ") + kHostile,
      kHostile,
      {kHostile, "%"},
      {"time per step", "µs"},
      {{kHostile, SeriesStyle::kMeasured, {{0, 2}, {10, kNaN}, {20, 3, {}, {}, kHostile}, {30, kInfinity}, {40, 2.5}}},
       {"nothing", SeriesStyle::kMeasured, {}}}};
}

LineChart cost() {
  Series all = {"settings", SeriesStyle::kScatter, {}};
  for (int i = 0; i < 80; ++i) {
    const double memory = 40 + 3.1 * ((i * 37) % 80);
    all.points.push_back({memory, 900 / memory + (i * 53) % 17, {}, {}, "setting " + std::to_string(i)});
  }
  Series front = {
      "best for their memory", SeriesStyle::kFront, {{43, 24}, {62, 14.9}, {100, 9.2}, {180, 5.1}, {260, 3.6}}};
  return {"cost",
          "Memory against time",
          "Each mark is a setting; none is better in both than those on the steps.",
          {"memory", "MiB"},
          {"time per step", "ms"},
          {all, front}};
}

HeatMap best_kinds() {
  HeatMap map = {"kinds",
                 "The fastest kind of cell",
                 "Letters: R rows, S segmented, B batch. Grey: took too long.",
                 "objects that move",
                 "objects per cell",
                 {},
                 {},
                 {"time per step", "ms", true},
                 {}};
  for (const int moving : {0, 1, 2, 5, 10, 20, 50, 100}) map.columns.push_back(std::to_string(moving) + " %");
  for (const int population : {10, 30, 100, 300, 1000, 3000}) map.rows.push_back(std::to_string(population));
  for (std::size_t row = 0; row < map.rows.size(); ++row) {
    for (std::size_t column = 0; column < map.columns.size(); ++column) {
      const double time = 0.02 * std::pow(3.0, static_cast<double>(row)) * static_cast<double>(column + 1);
      Tile tile = {column, row, time, row < 2 ? "R" : column < 4 ? "S" : "B", "", time * 0.9, time * 1.2};
      if (row == 5 && column > 5) tile = {column, row, {}, "–", "more than a minute"};
      if (row == 0 && column == 0) tile.value = 0;  // not on a scale of logarithms
      map.tiles.push_back(tile);
    }
  }
  return map;
}

HeatMap gains() {
  HeatMap map = {"gains",
                 "Gain over the engine's default",
                 "Of each setting, on each scene.",
                 "setting",
                 "scene",
                 {"default", "counts", "cells of 100", "cells of 1000", "segments of 64 endpoints, sorted globally"},
                 {"uniform:n=100000,moving=0.1,churn=0.005", "towers", kHostile},
                 {"gain", "×"},
                 {}};
  for (std::size_t row = 0; row < map.rows.size(); ++row) {
    for (std::size_t column = 0; column < map.columns.size(); ++column) {
      map.tiles.push_back(
          {column, row, 1 + 0.13 * static_cast<double>(row * column) - 0.05 * static_cast<double>(row), "", ""});
    }
  }
  return map;
}

Timeline step_of(std::size_t lanes, std::size_t tasks, const char* id) {
  Timeline timeline = {id, "One step, task by task", "Each lane is a worker.", {}, {"route", "drain", "order", "merge"},
                       {}};
  for (std::size_t lane = 0; lane < lanes; ++lane) timeline.lanes.push_back("worker " + std::to_string(lane + 1));
  std::vector<double> free_from(lanes, 0);
  for (std::size_t task = 0; task < tasks; ++task) {
    const std::size_t group = 4 * task / tasks;
    if (task > 0 && group != 4 * (task - 1) / tasks) {
      std::fill(free_from.begin(), free_from.end(), *std::max_element(free_from.begin(), free_from.end()));
    }
    const std::size_t lane = std::min_element(free_from.begin(), free_from.end()) - free_from.begin();
    const double duration = 1e-6 * static_cast<double>(20 + task * 7919 % 60);
    timeline.spans.push_back({lane, free_from[lane], duration, group, "task " + std::to_string(task)});
    free_from[lane] += duration;
  }
  return timeline;
}

Table claims() {
  return {"claims",
          "The paper says / here",
          "Exponents are slopes of a least-squares line through logarithms; their spread is the 95 % interval.",
          {"claim", "section", "the paper", "here", "agrees", kHostile},
          {{{"classic grows with exponent"}, {"2.2"}, {"1.76", 1.76}, {"1.74", 1.74, 1.70, 1.79}, {"yes"}, {kHostile}},
           {{"objects per cell"}, {"4.3"}, {"300", 300}, {"72", 72}, {"no: rows are compared at once"}, {""}},
           {{"gain of a global sort when all move"}, {"4.1"}, {"30 %", 30}, {"1 041 %", 1041}, {"yes"}, {""}},
           {{"cut-off, events"}, {"4.2"}, {"80", 80}, {"never", kInfinity}, {"no"}, {""}},
           {{"not measured"}, {"4.10"}, {"9", 9}, {"", {}}, {"–"}, {""}}}};
}

}  // namespace

Report sample_report(std::size_t tasks) {
  Report report;
  report.study = "sample";
  report.title = std::string("Every kind of chart ") + kHostile;
  report.summary =
      "Numbers in this report are made up: it shows each kind of chart, for tests and for those who change the "
      "page.\n\n"
      "Made with `sample_report()`. The grid speeds up 52 times on 64 workers (simulated).";
  report.command = "sweepgrid study sample --out '" + std::string(kHostile) + "'";
  report.sections.push_back({"Curves",
                             "With spreads, on axes of logarithms where these belong.",
                             {speedup(), growth(), gaps(), cost()},
                             {},
                             {},
                             {}});
  report.sections.push_back(
      {std::string("Maps and tables ") + kHostile, kHostile, {}, {best_kinds(), gains()}, {}, {claims()}});
  report.sections.push_back(
      {"Timelines", "", {}, {}, {step_of(8, tasks, "step"), step_of(64, 40 * tasks, "large-step")}, {}});
  return report;
}

}  // namespace sweepgrid::study
