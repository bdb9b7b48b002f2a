#include "study/stability/stability_study.hpp"

#include <cstdio>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "accuracy/methods.hpp"
#include "accuracy/regimes.hpp"
#include "cli/standard_streams.hpp"
#include "study/point_store.hpp"
#include "study/report_files.hpp"
#include "study/study_points.hpp"

namespace sweepgrid::study {
namespace {

using accuracy::Method;
using accuracy::Regime;
using accuracy::Verdict;

// The methods in one scene, in turn.
nlohmann::json try_all(const std::vector<Method>& methods, const std::string& scene, std::uint64_t steps,
                       const accuracy::RunBudget& budget) {
  const accuracy::KnownScript known = accuracy::know_script(scene, steps);
  nlohmann::json trials = nlohmann::json::object();
  for (const Method& method : methods) {
    trials[method.name] = trial_json(accuracy::try_method(method, known, budget));
  }
  return trials;
}

std::string growing_key(const std::string& scene, std::uint64_t objects) {
  return fmt::format("{} of {}", scene, objects);
}

void add_growing_points(const StabilitySize& size, std::vector<StudyPoint>& points) {
  for (const std::uint64_t objects : size.growing) {
    const std::uint64_t steps = size.growing_steps;
    const auto add = [&points, &size, objects, steps](const std::string& name, const std::string& scene) {
      points.push_back({growing_key(name, objects), 1e-7 * static_cast<double>(objects * objects),
                        [&size, scene, steps] { return try_all(growing_methods(), scene, steps, size.budget); }});
    };
    add(calm_name(), accuracy::calm_scene(objects, steps));
    for (const Regime& regime : growing_regimes()) {
      add(point_name(regime, regime.values.back()), scene_at(regime, regime.values.back(), objects, steps));
    }
  }
}

std::vector<StudyPoint> study_points(const StabilitySize& size) {
  std::vector<StudyPoint> points;
  const auto add = [&](const std::string& name, double cost, const std::string& scene,
                       const accuracy::RunBudget& budget) {
    points.push_back(
        {name, cost, [&size, scene, budget] { return try_all(accuracy::methods(), scene, size.steps, budget); }});
  };
  add(calm_name(), 1, accuracy::calm_scene(size.objects, size.steps), size.budget);
  for (const Regime& regime : stability_regimes()) {
    for (std::size_t i = 0; i < regime.values.size(); ++i) {
      const std::string& value = regime.values[i];
      accuracy::RunBudget budget = size.budget;
      if (regime.id == accuracy::memory_regime().id) budget.bytes = std::stoull(value) << 20;
      // What is hard takes longer.
      add(point_name(regime, value), 1 + static_cast<double>(i), scene_at(regime, value, size.objects, size.steps),
          budget);
    }
  }
  add_growing_points(size, points);
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
        trial.verdict != Verdict::kOutOfMemory && trial.verdict != Verdict::kOverBudget) {
      return false;
    }
  }
  return true;
}

// The results, and whether the engine was exact in all of them.
std::pair<StabilityResults, bool> collect(const StabilitySize& size, const std::vector<StudyPoint>& points,
                                          const PointStore& store) {
  StabilityResults results;
  bool exact = true;
  std::map<std::string, SceneTrials> rest;
  for (const StudyPoint& point : points) {
    rest[point.key] = store.read(point.key, trials_of);
    exact = exact && engine_is_exact(rest[point.key]);
  }
  const auto take = [&rest](const std::string& key) { return std::move(rest.extract(key).mapped()); };
  results.calm = take(calm_name());
  for (const std::uint64_t objects : size.growing) {
    auto& trials = results.growing[objects];
    trials[calm_name()] = take(growing_key(calm_name(), objects));
    for (const Regime& regime : growing_regimes()) {
      const std::string name = point_name(regime, regime.values.back());
      trials[name] = take(growing_key(name, objects));
    }
  }
  results.hard = std::move(rest);
  return {std::move(results), exact};
}

}  // namespace

std::string calm_name() { return "calm"; }

std::string point_name(const Regime& regime, const std::string& value) { return regime.id + "=" + value; }

std::vector<Regime> stability_regimes() {
  std::vector<Regime> all = accuracy::regimes();
  all.push_back(accuracy::memory_regime());
  return all;
}

std::vector<Regime> growing_regimes() {
  std::vector<Regime> some;
  for (const Regime& regime : accuracy::regimes()) {
    if (regime.id == "speed" || regime.id == "teleport" || regime.id == "churn") some.push_back(regime);
  }
  return some;
}

std::vector<Method> growing_methods() {
  std::vector<Method> some;
  for (const char* name : {"cell/classic", "cell/batch", "engine", "octree", "bullet/dbvt", "bullet/axis32"}) {
    if (const auto method = accuracy::find_method(name)) some.push_back(*method);
  }
  return some;
}

StabilitySize StabilitySize::of(bool quick) {
  StabilitySize size;
  if (quick) size = {800, 10, {std::uint64_t{1} << 30, 2}, {250, 500, 1000, 2000}, 4};
  return size;
}

bool stability_study(const StudyOptions& options) { return stability_study(options, StabilitySize::of(options.quick)); }

bool stability_study(const StudyOptions& options, const StabilitySize& size) {
  const std::filesystem::path folder = make_out_folder(options);
  check_study_files("stability", folder);
  const nlohmann::json parameters = {{"objects", size.objects},    {"steps", size.steps},
                                     {"bytes", size.budget.bytes}, {"seconds", size.budget.seconds},
                                     {"growing", size.growing},    {"growing_steps", size.growing_steps}};
  PointStore store(folder, Fingerprint::here("stability", parameters), options.points);
  for (const std::string& note : store.notes()) show_on_stderr(fmt::format("{}\n", note));
  const std::vector<StudyPoint> points = study_points(size);
  measure_points("study stability", points, store);
  const auto [results, exact] = collect(size, points, store);
  const ReportFiles files = write_report(stability_report(size, results, options.quick), folder);
  fmt::print("{}\n", files.json.string());
  if (!files.html.empty()) fmt::print("{}\n", files.html.string());
  return exact;
}

}  // namespace sweepgrid::study
