#include "study/figures/figure_sections.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "study/figures/figure_plans.hpp"

namespace sweepgrid::study {
namespace {

/// A chart to be: a figure's systems over its x.
struct ChartPlan {
  const char* figure;
  const char* id;
  const char* title;
  const char* caption;
  Axis x;
  bool log_y;
};

const ChartPlan kCharts[] = {
    {figure::k2,
     "figure-2",
     "Figure 2: growth with the number of objects",
     "All objects move; nothing comes or goes. One cell holds all objects; the cells of a grid hold about 300.",
     {"objects", "", true},
     true},
    {figure::k8,
     "figure-8",
     "Figure 8: one cell, one insert and one erase in each step",
     "3000 objects, of which more and more move.",
     {"moving objects", "", false},
     true},
    {figure::k9,
     "figure-9",
     "Figure 9: one cell, more and more inserts and erases",
     "3000 objects, of which 150 move. As many are inserted as are erased.",
     {"inserts and erases per step", "", true},
     true},
    {figure::k10,
     "figure-10",
     "Figure 10: grid, more and more inserts and erases",
     "100 000 objects, of which 10 000 move, in cells of about 300.",
     {"inserts and erases per step", "", false},
     true},
    {figure::k11,
     "figure-11",
     "Figure 11: everything grows",
     "10 % of the objects move, 0.5 % are inserted and 0.5 % erased in each step.",
     {"objects", "", true},
     true},
    {figure::kPopulation,
     "population",
     "How many objects a cell should hold",
     "10 % of the objects move, 0.5 % are inserted and 0.5 % erased in each step, in grids of cells of several sizes.",
     {"objects per cell", "", true},
     true},
    {figure::kSegments,
     "segments",
     "How long a segment should be",
     "One cell of 3000 objects.",
     {"endpoints per segment", "", true},
     false},
    {figure::kSorts,
     "sorts",
     "Global against local sort",
     "One cell whose objects all move. Few updates at a time are sorted locally, many globally.",
     {"objects", "", true},
     true},
    {figure::kCoherence,
     "coherence",
     "Coherence: how many objects move",
     "Nothing comes or goes; moving objects move by a tenth of their width per step.",
     {"share of the objects that moves", "", true},
     true},
    {figure::kSpeed,
     "speed",
     "Coherence: how fast objects move",
     "All objects move; nothing comes or goes.",
     {"widths per step", "", true},
     true},
    {figure::kClumped,
     "clumped",
     "Clumped objects",
     "0.5 % of the objects are inserted and 0.5 % erased in each step, into 16 clumps or uniformly.",
     {"share of the objects that moves", "", true},
     true},
    {figure::kReplaced,
     "replaced",
     "From sweep and prune to the sweeping plane",
     "One cell of 3000 objects, of which a tenth moves and a part is replaced in each step.",
     {"share of the objects that is replaced per step", "", true},
     true},
};

/// Exact counts as a chart.
struct CountPlan {
  const char* figure;
  const char* id;
  const char* title;
  const char* caption;
  const char* count;
  Results::Figure value;
};

double swaps_per_step(const Entry& entry) { return entry.per_step(entry.work.cells.swaps); }
double box_tests_per_step(const Entry& entry) { return entry.per_step(entry.work.cells.box_tests); }

const CountPlan kCounts[] = {
    {figure::k2, "figure-2-swaps", "Figure 2: swaps", "Exact counts of the runs above.", "swaps per step",
     swaps_per_step},
    {figure::kFlat, "two-dimensions", "Swaps in two dimensions", "As Figure 2, with squares in a square.",
     "swaps per step", swaps_per_step},
    {figure::kInsertWork, "insertion-swaps", "Swaps of inserts and erases",
     "Ten inserts and ten erases in each step; nothing moves.", "swaps per step", swaps_per_step},
    {figure::kInsertWork, "insertion-tests", "Box tests of inserts and erases", "Exact counts of the same runs.",
     "box tests per step", box_tests_per_step},
};

Point time_point(const Entry& entry) {
  const Spread time = spread(entry.seconds);
  return {entry.x, 1e3 * time.median, 1e3 * time.low, 1e3 * time.high,
          entry.complaint.empty() ? "" : "pairs were wrong: " + entry.complaint};
}

std::string law_name(const std::string& system, const PowerLaw& law) {
  return fmt::format("{}: n^{:.2f} ({:.2f} to {:.2f})", system, law.exponent, law.exponent_low, law.exponent_high);
}

// Of a law of seconds, in milliseconds as time_point().
Series law_series(const std::string& system, const PowerLaw& law, const std::vector<const Entry*>& entries) {
  Series series{law_name(system, law), SeriesStyle::kFitted, {}, system};
  for (const Entry* entry : entries) series.points.push_back({entry->x, 1e3 * law(entry->x)});
  return series;
}

LineChart time_chart(const ChartPlan& plan, const Results& results) {
  LineChart chart{plan.id, plan.title, plan.caption, plan.x, {"time per step", "ms", plan.log_y}, {}};
  for (const std::string& system : results.systems(plan.figure)) {
    Series& series = chart.series.emplace_back(Series{system, SeriesStyle::kMeasured, {}});
    for (const Entry* entry : results.series(plan.figure, system)) series.points.push_back(time_point(*entry));
  }
  return chart;
}

LineChart count_chart(const CountPlan& plan, const Results& results) {
  LineChart chart{plan.id, plan.title, plan.caption, {"objects", "", true}, {plan.count, "", true}, {}};
  for (const std::string& system : results.systems(plan.figure)) {
    Series series{system, SeriesStyle::kMeasured, {}};
    for (const Entry* entry : results.series(plan.figure, system)) {
      if (plan.value(*entry) > 0) series.points.push_back({entry->x, plan.value(*entry)});
    }
    if (!series.points.empty()) chart.series.push_back(std::move(series));
  }
  return chart;
}

Cell exponent_cell(const PowerLaw& law) {
  return {fmt::format("{:.3f} ({:.3f} to {:.3f})", law.exponent, law.exponent_low, law.exponent_high), law.exponent,
          law.exponent_low, law.exponent_high};
}

// Exponents of time and of swaps, for a figure whose x is a number of objects.
Table exponents_table(const std::string& figure, const Results& results) {
  Table table{"exponents",
              "Fitted exponents",
              "Least squares over the logarithms, with the 95 % interval. Swaps are exact counts; systems without "
              "endpoints have none.",
              {"System", "Exponent of time", "Exponent of swaps", "Sizes"},
              {}};
  for (const std::string& system : results.systems(figure)) {
    const auto time = results.law(figure, system, median_seconds);
    const auto swaps = results.law(figure, system, swaps_per_step);
    const auto entries = results.series(figure, system);
    table.rows.push_back({{system},
                          time ? exponent_cell(*time) : Cell{"too few sizes"},
                          swaps ? exponent_cell(*swaps) : Cell{"–"},
                          {fmt::format("{} to {}", entries.front()->x, entries.back()->x)}});
  }
  return table;
}

std::string scene_of(const Results& results, const std::string& figure) {
  for (const Results::Played& played : results.all()) {
    if (played.figure == figure) return played.contest.scene;
  }
  return "";
}

// Figure 2 has its power laws drawn in; for the paper's own system only, or there would be nothing else to see.
void add_growth(Section& section, const Results& results) {
  const std::string classic = system_name::one_cell(CellKind::kClassic);
  if (const auto law = results.law(figure::k2, classic, median_seconds)) {
    section.charts[0].series.push_back(law_series(classic, *law, results.series(figure::k2, classic)));
  }
  section.tables.push_back(exponents_table(figure::k2, results));
}

void add_counts(Section& section, const std::string& figure, const Results& results) {
  for (const CountPlan& plan : kCounts) {
    if (plan.figure == figure) section.charts.push_back(count_chart(plan, results));
  }
}

}  // namespace

std::vector<Section> figure_sections(const Results& results) {
  std::vector<Section> sections;
  for (const ChartPlan& plan : kCharts) {
    const std::string scene = scene_of(results, plan.figure);
    if (scene.empty()) continue;
    Section& section = sections.emplace_back();
    section.title = plan.title;
    section.text = fmt::format("The first of its scenes: `{}`", scene);
    section.charts.push_back(time_chart(plan, results));
    if (plan.figure == figure::k2) add_growth(section, results);
    add_counts(section, plan.figure, results);
  }
  Section counts{
      "Work of inserts and erases, and of two dimensions", "Exact counts; times play no part.", {}, {}, {}, {}};
  for (const char* figure : {figure::kFlat, figure::kInsertWork}) {
    if (!scene_of(results, figure).empty()) add_counts(counts, figure, results);
  }
  if (!counts.charts.empty()) sections.push_back(std::move(counts));
  return sections;
}

bool all_exact(const Results& results) {
  return std::all_of(results.all().begin(), results.all().end(), [](const Results::Played& played) {
    return std::all_of(played.contest.entries.begin(), played.contest.entries.end(),
                       [](const Entry& entry) { return entry.complaint.empty(); });
  });
}

Section exactness_section(const Results& results) {
  Section section;
  section.title = "Exactness";
  Table table{"exactness",
              "Every run, held against an independent computation",
              "At the end of a run each system's overlapping pairs are compared, both ways, with those that a sort "
              "along x and a sweep find in the same boxes.",
              {"Figure", "Scene", "Systems", "Pairs", "Result"},
              {}};
  std::size_t runs = 0;
  for (const Results::Played& played : results.all()) {
    std::string result = "all equal";
    for (const Entry& entry : played.contest.entries) {
      ++runs;
      if (!entry.complaint.empty()) result = fmt::format("{}: {}", entry.system, entry.complaint);
    }
    const auto systems = static_cast<double>(played.contest.entries.size());
    const auto pairs = static_cast<double>(played.contest.pairs);
    table.rows.push_back({{played.figure},
                          {played.contest.scene},
                          {fmt::format("{}", systems), systems},
                          {fmt::format("{}", pairs), pairs},
                          {result}});
  }
  section.text =
      all_exact(results)
          ? fmt::format("All {} runs ended with exactly the pairs that the independent computation found.", runs)
          : "SOME RUNS ENDED WITH WRONG PAIRS: their times mean nothing. See the table.";
  section.tables.push_back(std::move(table));
  return section;
}

}  // namespace sweepgrid::study
