#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "study/stability/stability_study.hpp"

namespace sweepgrid::study {
namespace {

using accuracy::Claim;
using accuracy::Method;
using accuracy::Regime;
using accuracy::Trial;
using accuracy::Verdict;

// At most four characters.
std::string mark(Verdict verdict) {
  switch (verdict) {
    case Verdict::kExact:
      return "=";
    case Verdict::kSuperset:
      return "+";
    case Verdict::kMisses:
      return "miss";
    case Verdict::kTakesBad:
      return "bad";
    case Verdict::kOutOfTime:
      return "time";
    case Verdict::kOutOfMemory:
      return "mem";
    case Verdict::kOverBudget:
      return "over";
    case Verdict::kError:
      return "err";
    case Verdict::kCrash:
      break;
  }
  return "dead";
}

/// How many times as much as in the calm scene a step costs; absent when either was not measured.
std::optional<double> cost(const Trial& trial, const SceneTrials& calm, const std::string& method) {
  const double calm_ms = calm.at(method).step_ms;
  if (trial.step_ms <= 0 || calm_ms <= 0) return std::nullopt;
  return trial.step_ms / calm_ms;
}

std::string label(const Trial& trial, const std::string& method) {
  std::string text = fmt::format("{}: {}", method, accuracy::verdict_name(trial.verdict));
  if (trial.step_ms > 0) text += fmt::format(", {:.3g} ms per step, at most {:.3g}", trial.step_ms, trial.most_step_ms);
  if (trial.missed_pairs > 0) text += fmt::format(", {} of {} pairs missed", trial.missed_pairs, trial.true_pairs);
  if (trial.extra_pairs > 0) text += fmt::format(", {} pairs too many beside {}", trial.extra_pairs, trial.true_pairs);
  if (!trial.error.empty()) text += ": " + trial.error;
  return text;
}

HeatMap regime_map(const Regime& regime, const StabilityResults& results) {
  HeatMap map;
  map.id = "regime-" + regime.id;
  map.title = regime.title;
  map.caption = fmt::format("Scene `{}`.", regime.scene);
  map.column_label = regime.parameter;
  map.row_label = "method";
  map.columns = regime.values;
  map.value = {"cost of a step relative to calm", "", true};
  for (const Method& method : accuracy::methods()) {
    for (std::size_t column = 0; column < regime.values.size(); ++column) {
      const Trial& trial = results.hard.at(point_name(regime, regime.values[column])).at(method.name);
      map.tiles.push_back({column, map.rows.size(), cost(trial, results.calm, method.name), mark(trial.verdict),
                           label(trial, method.name)});
    }
    map.rows.push_back(method.name);
  }
  return map;
}

struct Worst {
  double cost = 1;
  std::string where = calm_name();

  void see(double other, const std::string& place) {
    if (other > cost) cost = other, where = place;
  }
};

/// A method over all regimes: the worst cost, and what else there is to say against it.
struct Record {
  Worst worst;
  Worst worst_uncrowded;
  std::vector<std::string> dear;   // regimes that cost more than kDear times as much
  std::vector<std::string> fails;  // "verdict: regimes from value on"
};

constexpr double kDear = 20;
constexpr double kCrowded = 0.1;  // part of all pairs that overlaps: from there on every method has o = n^2 to tell

bool crowded(const Trial& trial, const StabilitySize& size) {
  const double n = static_cast<double>(size.objects);
  return static_cast<double>(trial.true_pairs) > kCrowded * n * (n - 1) / 2 * static_cast<double>(trial.steps + 1);
}

Record record_of(const Method& method, const StabilitySize& size, const StabilityResults& results) {
  Record record;
  std::vector<std::pair<Verdict, std::vector<std::string>>> failures;
  for (const Regime& regime : stability_regimes()) {
    double dearest = 0;
    std::vector<Verdict> seen;
    for (const std::string& value : regime.values) {
      const Trial& trial = results.hard.at(point_name(regime, value)).at(method.name);
      const double times = cost(trial, results.calm, method.name).value_or(0);
      dearest = std::max(dearest, times);
      record.worst.see(times, point_name(regime, value));
      if (!crowded(trial, size)) record.worst_uncrowded.see(times, point_name(regime, value));
      const bool kept =
          trial.verdict == Verdict::kExact || (trial.verdict == Verdict::kSuperset && method.claim == Claim::kSuperset);
      // Named once, where it is seen first.
      if (kept || std::find(seen.begin(), seen.end(), trial.verdict) != seen.end()) continue;
      seen.push_back(trial.verdict);
      auto failure = std::find_if(failures.begin(), failures.end(),
                                  [&](const auto& known) { return known.first == trial.verdict; });
      if (failure == failures.end()) failure = failures.insert(failures.end(), {trial.verdict, {}});
      failure->second.push_back(point_name(regime, value));
    }
    if (dearest > kDear) record.dear.push_back(fmt::format("{} ({:.0f})", regime.id, dearest));
  }
  for (const auto& [verdict, where] : failures) {
    record.fails.push_back(fmt::format("{} from {}", accuracy::verdict_name(verdict), fmt::join(where, ", ")));
  }
  return record;
}

Table failure_table(const StabilitySize& size, const StabilityResults& results) {
  Table table;
  table.id = "failures";
  table.title = "Where each method fails, and how";
  table.caption =
      "Costs are relative to the same method's in the calm scene; crowded is where more than a tenth of all pairs "
      "overlaps, n² things to tell. A failure is named with the first value at which it is seen.";
  table.columns = {"method",
                   "claims",
                   "calm, ms per step",
                   "worst cost",
                   "where",
                   "worst, where not crowded",
                   "where",
                   "over 20 times as dear",
                   "breaks down"};
  for (const Method& method : accuracy::methods()) {
    const Record record = record_of(method, size, results);
    const double calm = results.calm.at(method.name).step_ms;
    const std::string claim = method.claim == Claim::kExact ? "exact" : "superset";
    table.rows.push_back({{method.name},
                          {method.refuses_bad_input ? claim + ", refuses bad input" : claim},
                          {fmt::format("{:.3g}", calm), calm},
                          {fmt::format("{:.3g}", record.worst.cost), record.worst.cost},
                          {record.worst.where},
                          {fmt::format("{:.3g}", record.worst_uncrowded.cost), record.worst_uncrowded.cost},
                          {record.worst_uncrowded.where},
                          {record.dear.empty() ? "nowhere" : fmt::format("{}", fmt::join(record.dear, ", "))},
                          {record.fails.empty() ? "nowhere" : fmt::format("{}", fmt::join(record.fails, "; "))}});
  }
  return table;
}

LineChart growth_chart(const Regime& regime, const StabilityResults& results) {
  LineChart chart;
  const std::string name = point_name(regime, regime.values.back());
  chart.id = "growth-" + regime.id;
  chart.title = fmt::format("{}, {}: {}", regime.title, regime.parameter, regime.values.back());
  chart.caption = fmt::format(
      "Cost of a step of `{}` relative to the same method's of as many objects in the calm scene. A line ends where a "
      "method had no time for a step.",
      name);
  chart.x = {"objects", "", true};
  chart.y = {"cost of a step relative to calm", "", true};
  for (const Method& method : growing_methods()) {
    Series& series = chart.series.emplace_back();
    series.name = method.name;
    for (const auto& [objects, trials] : results.growing) {
      const Trial& trial = trials.at(name).at(method.name);
      const std::optional<double> times = cost(trial, trials.at(calm_name()), method.name);
      if (times)
        series.points.push_back({.x = static_cast<double>(objects), .y = *times, .label = label(trial, method.name)});
    }
  }
  return chart;
}

Section growth_section(const StabilitySize& size, const StabilityResults& results) {
  Section section;
  section.title = "Growth";
  section.text = fmt::format(
      "A cell over everything swaps each endpoint that moves with all that it passes: where nothing stays near its "
      "place, "
      "a step takes n² swaps, and calm about n. {} steps; otherwise as above.",
      size.growing_steps);
  for (const Regime& regime : growing_regimes()) section.charts.push_back(growth_chart(regime, results));
  return section;
}

}  // namespace

Report stability_report(const StabilitySize& size, const StabilityResults& results, bool quick) {
  Report report;
  report.study = "stability";
  report.title = "Where broad phases break";
  report.command = quick ? "sweepgrid study stability --quick" : "sweepgrid study stability";
  report.summary = fmt::format(
      "Every method in scenes that become hard in one way at a time. All scenes are the calm one, `{}`, with other "
      "parameters. One thread; times are processor time, the median of the steps.",
      accuracy::calm_scene(size.objects, size.steps));
  Section& failures = report.sections.emplace_back();
  failures.title = "Failures";
  failures.tables.push_back(failure_table(size, results));
  Section& maps = report.sections.emplace_back();
  maps.title = "Regimes";
  maps.text = fmt::format(
      "Colours: cost of a step relative to the same method's in the calm scene. Marks: = exact; + superset; miss: "
      "pairs "
      "were missed; bad: took a box with a NaN or min > max; time: a trial's {} s did not suffice; mem: nor did {} MB, "
      "or what is said below; "
      "over: refused a step for want of memory, and was as before it; "
      "err: an exception; dead: the process crashed. Pairs are compared with T0 after every step.",
      size.budget.seconds, size.budget.bytes >> 20);
  for (const Regime& regime : stability_regimes()) maps.maps.push_back(regime_map(regime, results));
  report.sections.push_back(growth_section(size, results));
  return report;
}

}  // namespace sweepgrid::study
