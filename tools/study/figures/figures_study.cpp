#include "study/figures/figures_study.hpp"

#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/standard_streams.hpp"
#include "study/figures/claim.hpp"
#include "study/figures/figure_plans.hpp"
#include "study/figures/figure_sections.hpp"
#include "study/figures/paper_claims.hpp"
#include "study/figures/results.hpp"
#include "study/point_store.hpp"
#include "study/report_files.hpp"
#include "study/study_points.hpp"

namespace sweepgrid::study {
namespace {

std::string point_key(const FigurePoint& point) { return fmt::format("figure {}: {}", point.figure, point.name); }

std::vector<StudyPoint> study_points(const std::vector<FigurePoint>& points) {
  std::vector<StudyPoint> result;
  result.reserve(points.size());
  for (const FigurePoint& point : points) {
    result.push_back({point_key(point), point.cost, [&point] { return to_json(play(point.plan)); }});
  }
  return result;
}

std::string command(const FiguresOptions& options) {
  std::string text = "sweepgrid study figures";
  if (options.study.quick) text += " --quick";
  if (!options.figures.empty()) text += fmt::format(" --figure {}", fmt::join(options.figures, " "));
  return text;
}

std::string summary(const std::vector<Claim>& claims, bool exact) {
  std::size_t counts[4] = {};
  for (const Claim& claim : claims) ++counts[static_cast<std::size_t>(judge(claim))];
  return fmt::format(
      "The figures of Tracy, Buss and Woods, \"Efficient Large-Scale Sweep and Prune Methods with AABB Insertion and "
      "Removal\" (2009), measured on this machine with the parameters of its section 4: uniform unit cubes, 5 % "
      "volumetric density, a tenth of a width per step, bouncing off the walls, one thread. Of {} claims {} agree, {} "
      "differ, {} cannot be compared and {} were not measured in this run. {}",
      claims.size(), counts[0], counts[1], counts[2], counts[3],
      exact ? "Every run ended with exactly the right pairs." : "SOME RUNS ENDED WITH WRONG PAIRS.");
}

Report make_report(const FiguresOptions& options, const Results& results) {
  const std::vector<Claim> claims = paper_claims(results);
  Report report;
  report.study = "figures";
  report.title = "The paper, figure by figure";
  report.summary = summary(claims, all_exact(results));
  report.command = command(options);
  Section& section = report.sections.emplace_back();
  section.title = "The paper says / here";
  section.text =
      "Times are processor time of the one thread that works, per step, from boxes at hand to events (or, in one cell "
      "by itself, overlap deltas) at hand. The systems take turns on the same steps, round by round; bars and brackets "
      "span the rounds.";
  section.tables.push_back(claims_table(claims));
  for (Section& figure : figure_sections(results)) report.sections.push_back(std::move(figure));
  report.sections.push_back(exactness_section(results));
  return report;
}

}  // namespace

std::vector<std::string> figure_numbers() { return {figure::k2, figure::k8, figure::k9, figure::k10, figure::k11}; }

bool figures_study(const FiguresOptions& options) {
  return figures_study(options, figure_points(options.study.quick, options.figures));
}

bool figures_study(const FiguresOptions& options, const std::vector<FigurePoint>& points) {
  const std::filesystem::path folder = make_out_folder(options.study);
  check_study_files("figures", folder);
  // Which figures are asked for is no parameter of a point.
  PointStore store(folder, Fingerprint::here("figures", {{"quick", options.study.quick}}), options.study.points);
  for (const std::string& note : store.notes()) show_on_stderr(fmt::format("{}\n", note));
  measure_points("study figures", study_points(points), store);
  Results results;
  for (const FigurePoint& point : points) results.add(point.figure, store.read(point_key(point), contest_of));
  const ReportFiles files = write_report(make_report(options, results), folder);
  fmt::print("{}\n", files.json.string());
  if (!files.html.empty()) fmt::print("{}\n", files.html.string());
  return all_exact(results);
}

}  // namespace sweepgrid::study
