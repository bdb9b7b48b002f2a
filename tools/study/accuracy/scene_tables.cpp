#include "study/accuracy/scene_tables.hpp"

#include <fmt/format.h>

#include "study/accuracy/best_points.hpp"

namespace sweepgrid::study {
namespace {

Cell text(std::string value) { return {std::move(value)}; }
Cell number(double value) { return {fmt::format("{:.4g}", value), value}; }
Cell count(std::uint64_t value) { return {fmt::format("{}", value), static_cast<double>(value)}; }
Cell part(double value) { return {fmt::format("{:.6f}", value), value}; }
Cell time(const Spread& ms) { return {fmt::format("{:.4g}", ms.median), ms.median, ms.low, ms.high}; }

Cell delays(const accuracy::DelayCounts& delays) {
  if (delays.off_time() == 0) return count(0);
  return {
      fmt::format("{} of {}, mean {:.2f}, most {:+}", delays.off_time(), delays.count(), delays.mean(), delays.most()),
      static_cast<double>(delays.off_time())};
}

Cell promise(const AccuracyPoint& point) {
  const bool outside = point.guarantee == Guarantee::kMayMiss && point.violations > 0;
  return text(guarantee_name(point.guarantee) +
              (outside ? fmt::format(" ({} boxes outside of their envelopes)", point.violations) : ""));
}

std::vector<Cell> row(const AccuracyPoint& point, double narrow_ns) {
  const accuracy::Accuracy& accuracy = point.accuracy;
  return {text(point.name),           promise(point),
          time(point.step_ms),        count(accuracy.missed_pairs),
          part(accuracy.recall()),    count(accuracy.extra_pairs),
          part(accuracy.precision()), delays(accuracy.begins),
          delays(accuracy.ends),      count(accuracy.reported_flicker),
          number(point.candidates),   time(point.total_ms(narrow_ns))};
}

Table truth_table(const SceneResult& result, std::size_t truth, const std::string& id, double narrow_ns) {
  const std::vector<AccuracyPoint> points = points_of(result, truth);
  const std::string name = truth_name(result.truths[truth]);
  Table table;
  table.id = fmt::format("{}-t{}", id, static_cast<int>(result.truths[truth]));
  table.title = name + ": every configuration";
  if (!points.empty()) {
    const accuracy::Accuracy& truths = points.front().accuracy;
    table.caption =
        fmt::format("{} pairs are true, summed over {} steps with the start; {} contacts, and {} begins that flicker.",
                    truths.true_pairs, truths.steps, truths.true_contacts, truths.true_flicker);
  }
  table.columns = {"configuration", "guarantee",       "ms per step",   "missed",  "recall",         "extra",
                   "precision",     "begins off time", "ends off time", "flicker", "pairs per step", "total ms"};
  for (const AccuracyPoint& point : points) table.rows.push_back(row(point, narrow_ns));
  for (const ConfigurationResult& one : result.configurations) {
    if (one.given_up.empty()) continue;
    std::vector<Cell> cells(table.columns.size());
    cells[0] = text(one.name);
    cells[1] = text("given up: " + one.given_up);
    table.rows.push_back(std::move(cells));
  }
  return table;
}

}  // namespace

std::vector<Table> scene_tables(const SceneResult& result, const std::string& id, double narrow_ns) {
  std::vector<Table> tables;
  for (std::size_t truth = 0; truth < result.truths.size(); ++truth) {
    tables.push_back(truth_table(result, truth, id, narrow_ns));
  }
  return tables;
}

Table best_table(const std::vector<SceneResult>& results, double narrow_ns) {
  Table table;
  table.id = "best";
  table.title = "The cheapest that missed nothing";
  table.caption = fmt::format(
      "Of all configurations that missed no pair of the truth in this run, whether or not they promise that. Total: "
      "with {:.4g} ns for each pair that is reported.",
      narrow_ns);
  table.columns = {"scene",
                   "truth",
                   "of a step",
                   "ms per step",
                   "of the total",
                   "total ms",
                   "extra pairs in %",
                   "its guarantee",
                   "double, ms per step",
                   "double, total ms"};
  for (const SceneResult& result : results) {
    for (std::size_t truth = 0; truth < result.truths.size(); ++truth) {
      const std::vector<AccuracyPoint> points = points_of(result, truth);
      const std::size_t step = cheapest_complete(points, 0);
      const std::size_t total = cheapest_complete(points, narrow_ns);
      std::vector<Cell> cells = {text(result.name), text(truth_name(result.truths[truth]))};
      if (total < points.size()) {
        cells.insert(cells.end(), {text(points[step].name), time(points[step].step_ms), text(points[total].name),
                                   time(points[total].total_ms(narrow_ns)), number(points[total].extra_percent()),
                                   text(guarantee_name(points[total].guarantee))});
      } else {
        cells.insert(cells.end(), {text("none"), {}, text("none"), {}, {}, {}});
      }
      cells.resize(table.columns.size());
      if (!points.empty() && points.front().name == configurations().front().name) {
        cells[cells.size() - 2] = time(points.front().step_ms);
        cells[cells.size() - 1] = time(points.front().total_ms(narrow_ns));
      }
      table.rows.push_back(std::move(cells));
    }
  }
  return table;
}

Table broken_table(const std::vector<std::string>& broken) {
  Table table;
  table.id = "broken-promises";
  table.title = "Promises that were not kept";
  table.columns = {"scene, configuration and truth"};
  for (const std::string& sentence : broken) table.rows.push_back({text(sentence)});
  return table;
}

}  // namespace sweepgrid::study
