#include "study/accuracy/accuracy_study.hpp"

#include <cmath>
#include <cstdio>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "accuracy/narrow_phase.hpp"
#include "cli/standard_streams.hpp"
#include "scenes/open_scene.hpp"
#include "study/accuracy/scene_charts.hpp"
#include "study/accuracy/scene_tables.hpp"
#include "study/point_store.hpp"
#include "study/report_files.hpp"
#include "study/study_points.hpp"

namespace sweepgrid::study {
namespace {

constexpr const char* kPrice = "narrow phase";

// Bad options are told before anything is measured.
std::vector<std::string> scenes_of(const AccuracyOptions& options, const AccuracySize& size) {
  if (options.narrow_cost && !(std::isfinite(*options.narrow_cost) && *options.narrow_cost >= 0)) {
    throw std::invalid_argument(fmt::format("--narrow-cost: {} is no price", *options.narrow_cost));
  }
  if (options.scenes.empty()) return default_accuracy_scenes(size);
  std::set<std::string> seen;
  for (const std::string& scene : options.scenes) {
    if (!seen.insert(scene).second) throw std::invalid_argument(fmt::format("scene {} is given twice", scene));
    static_cast<void>(open_scene(scene));
  }
  return options.scenes;
}

std::vector<StudyPoint> study_points(const std::vector<std::string>& scenes, const AccuracyOptions& options,
                                     const AccuracySize& size) {
  std::vector<StudyPoint> points;
  if (!options.narrow_cost) {
    points.push_back({kPrice, 1, [] {
                        const accuracy::NarrowPhasePrice price = accuracy::default_narrow_phase_price();
                        return nlohmann::json{{"ns", price.ns}, {"source", price.source}};
                      }});
  }
  constexpr double kExpected = 10;
  for (const std::string& scene : scenes) {
    points.push_back({"scene " + scene, kExpected, [&scene, &size] {
                        return scene_result_json(measure_scene(know_scene(scene, size.recorded_steps), size));
                      }});
  }
  return points;
}

std::string command(const AccuracyOptions& options) {
  std::string text = "sweepgrid study accuracy";
  if (!options.scenes.empty()) text += fmt::format(" {}", fmt::join(options.scenes, " "));
  if (options.study.quick) text += " --quick";
  if (options.narrow_cost) text += fmt::format(" --narrow-cost {}", *options.narrow_cost);
  return text;
}

std::vector<std::string> all_broken(const std::vector<SceneResult>& results) {
  std::vector<std::string> broken;
  for (const SceneResult& result : results) {
    for (std::string& sentence : broken_promises(result)) broken.push_back(std::move(sentence));
  }
  return broken;
}

Section scene_section(const SceneResult& result, std::size_t index, double narrow_ns) {
  Section section;
  const std::string id = fmt::format("scene-{}", index);
  section.title = result.name;
  section.text = fmt::format("{} objects, {} steps after the start; margins are in widths of {:.4g} world units.",
                             result.objects, result.steps, result.width);
  section.charts = scene_charts(result, id, narrow_ns);
  section.tables = scene_tables(result, id, narrow_ns);
  return section;
}

}  // namespace

std::vector<std::string> default_accuracy_scenes(const AccuracySize& size) {
  std::vector<std::string> scenes;
  for (const char* scene : {"uniform:", "fast:", "far:offset=1e3,", "far:offset=1e8,", "resting:", "turning:"}) {
    scenes.push_back(fmt::format("{}n={},steps={}", scene, size.objects, size.steps));
  }
  return scenes;
}

Report accuracy_report(const AccuracyOptions& options, const std::vector<SceneResult>& results, double narrow_ns,
                       const std::string& narrow_source) {
  const std::vector<std::string> broken = all_broken(results);
  Report report;
  report.study = "accuracy";
  report.title = "Speed against accuracy";
  report.command = command(options);
  report.summary = fmt::format(
      "Every setting that trades accuracy for time, alone and combined, beside three truths: T0, closed boxes overlap "
      "at "
      "the end of the step; T1, boxes that move linearly through the step overlap at some time; T2, for scenes of "
      "other "
      "shapes than boxes, the shapes touch. {}\n\nOne thread. Times are processor time of a step after the start, from "
      "the scene's boxes in double to events, conversions included: configurations take turns, round by round; the "
      "median, with the least and the most. A narrow phase costs {:.4g} ns per reported pair ({}).",
      broken.empty() ? "Every promise was kept." : "SOME PROMISES WERE NOT KEPT.", narrow_ns, narrow_source);
  Section& best = report.sections.emplace_back();
  best.title = "The best points";
  best.text =
      "*Exact*: these pairs and no others. *Superset only*: all of these, and others. *May miss*: neither. Names: "
      "`margin`, in widths; `moving margin`, as many displacements as the stride needs; `queries`, a box outside of "
      "its "
      "envelope makes a query; `exact`, events of the boxes among pairs of envelopes.";
  best.tables.push_back(best_table(results, narrow_ns));
  if (!broken.empty()) best.tables.push_back(broken_table(broken));
  for (std::size_t i = 0; i < results.size(); ++i) report.sections.push_back(scene_section(results[i], i, narrow_ns));
  return report;
}

bool accuracy_study(const AccuracyOptions& options) {
  return accuracy_study(options, AccuracySize::of(options.study.quick));
}

bool accuracy_study(const AccuracyOptions& options, const AccuracySize& size) {
  const std::vector<std::string> scenes = scenes_of(options, size);
  const std::filesystem::path folder = make_out_folder(options.study);
  check_study_files("accuracy", folder, scenes);
  // Which scenes are asked for is no parameter of a point.
  const nlohmann::json parameters = {
      {"steps", size.recorded_steps}, {"rounds", size.rounds}, {"most_pairs", size.most_pairs}};
  PointStore store(folder, Fingerprint::here("accuracy", parameters), options.study.points);
  for (const std::string& note : store.notes()) show_on_stderr(fmt::format("{}\n", note));
  const std::vector<StudyPoint> points = study_points(scenes, options, size);
  measure_points("study accuracy", points, store);
  double price = options.narrow_cost.value_or(0);
  std::string source = "as given";
  std::vector<SceneResult> results;
  for (const StudyPoint& point : points) {
    if (point.key != kPrice) {
      results.push_back(store.read(point.key, scene_result_of));
      continue;
    }
    std::tie(price, source) = store.read(point.key, [](const nlohmann::json& found) {
      return std::pair(member_of<double>(found, "ns"), member_of<std::string>(found, "source"));
    });
  }
  const ReportFiles files = write_report(accuracy_report(options, results, price, source), folder);
  fmt::print("{}\n", files.json.string());
  if (!files.html.empty()) fmt::print("{}\n", files.html.string());
  const std::vector<std::string> broken = all_broken(results);
  for (const std::string& sentence : broken) show_on_stderr(fmt::format("{}\n", sentence));
  return broken.empty();
}

}  // namespace sweepgrid::study
