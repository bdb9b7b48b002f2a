#include "study/stability/stability_study.hpp"

#include <cstdio>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "accuracy/methods.hpp"
#include "accuracy/regimes.hpp"
#include "study/point_store.hpp"
#include "study/report_files.hpp"
#include "study/study_points.hpp"

namespace sweepgrid::study {
namespace {

using accuracy::Method;
using accuracy::Regime;
using accuracy::Verdict;

constexpr const char* kCalm = "calm";

// All methods in one scene, in turn.
nlohmann::json try_all(const std::string& scene, const StabilitySize& size) {
  const accuracy::KnownScript known = accuracy::know_script(scene, size.steps);
  nlohmann::json trials = nlohmann::json::object();
  for (const Method& method : accuracy::methods()) {
    trials[method.name] = trial_json(accuracy::try_method(method, known, size.budget));
  }
  return trials;
}

std::vector<StudyPoint> study_points(const StabilitySize& size) {
  std::vector<StudyPoint> points;
  points.push_back({kCalm, 1, [&size] { return try_all(accuracy::calm_scene(size.objects, size.steps), size); }});
  for (const Regime& regime : accuracy::regimes()) {
    for (std::size_t i = 0; i < regime.values.size(); ++i) {
      const std::string& value = regime.values[i];
      // What is hard takes longer.
      points.push_back({regime.id + "=" + value, 1 + static_cast<double>(i),
                        [&] { return try_all(scene_at(regime, value, size.objects, size.steps), size); }});
    }
  }
  return points;
}

SceneTrials trials_of(const nlohmann::json& point) {
  SceneTrials trials;
  for (const auto& [method, trial] : point.items()) trials[method] = accuracy::trial_of(trial);
  return trials;
}

bool engine_is_exact(const SceneTrials& trials) {
  for (const auto& [method, trial] : trials) {
    if (method != "engine" && !method.starts_with("grid/")) continue;
    if (trial.missed_pairs > 0 || trial.extra_pairs > 0) return false;
    if (trial.verdict != Verdict::kExact && trial.verdict != Verdict::kOutOfTime &&
        trial.verdict != Verdict::kOutOfMemory) {
      return false;
    }
  }
  return true;
}

}  // namespace

StabilitySize StabilitySize::of(bool quick) {
  StabilitySize size;
  if (quick) size = {800, 10, {std::uint64_t{1} << 30, 2}};
  return size;
}

bool stability_study(const StudyOptions& options) { return stability_study(options, StabilitySize::of(options.quick)); }

bool stability_study(const StudyOptions& options, const StabilitySize& size) {
  const std::filesystem::path folder = make_out_folder(options);
  const nlohmann::json parameters = {
      {"objects", size.objects}, {"steps", size.steps}, {"bytes", size.budget.bytes}, {"seconds", size.budget.seconds}};
  PointStore store(folder, Fingerprint::here("stability", parameters), options.points);
  for (const std::string& note : store.notes()) fmt::print(stderr, "{}\n", note);
  const std::vector<StudyPoint> points = study_points(size);
  measure_points("study stability", points, store);
  StabilityResults results;
  bool exact = true;
  for (const StudyPoint& point : points) {
    SceneTrials trials = trials_of(*store.find(point.key));
    exact = exact && engine_is_exact(trials);
    (point.key == kCalm ? results.calm : results.hard[point.key]) = std::move(trials);
  }
  const ReportFiles files = write_report(stability_report(size, results, options.quick), folder);
  fmt::print("{}\n", files.json.string());
  if (!files.html.empty()) fmt::print("{}\n", files.html.string());
  return exact;
}

}  // namespace sweepgrid::study
