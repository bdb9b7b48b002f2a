#include "study/scaling/findings.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "setup/json_text.hpp"

namespace sweepgrid::study {
namespace {

using Json = nlohmann::json;

/// Reads members into places: name, place, name, place, and so on.
template <class Value, class... More>
void get_members(const Json& json, const char* name, Value& value, More&&... more) {
  get_member(json, name, value);
  if constexpr (sizeof...(more) > 0) get_members(json, std::forward<More>(more)...);
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

MeasuredThreads measured_of(const Json& json, std::uint64_t checksum) {
  MeasuredThreads result;
  get_member(json, "threads", result.threads);
  result.seconds = sum(member_of<std::vector<double>>(json, "step_s"));
  get_members(json, "round_s", result.round_seconds, "part_s", result.part_seconds, "busy_s", result.busy, "predicted",
              result.predicted, "replayed", result.replayed);
  for (const std::uint64_t found : member_of<std::vector<std::uint64_t>>(json, "checksums")) {
    result.same_events = result.same_events && found == checksum;
  }
  return result;
}

TimelineFindings timeline_of(const Json& json) {
  TimelineFindings result;
  get_members(json, "workers", result.workers, "stages", result.stages);
  for (const Json& task : member_of<nlohmann::json>(json, "tasks")) {
    result.tasks.push_back({task.at(0), task.at(1), task.at(2), task.at(3), task.at(4)});
  }
  return result;
}

void add_what_ifs(const ScalingPlan& plan, const PointStore& store, SceneFindings& scene) {
  scene.what_if_workers = plan.what_if_workers;
  for (const int population : plan.populations) {
    scene.what_ifs.push_back({"population", static_cast<double>(population),
                              store.get<Prediction>(scaling_key::population(scene.name, population))});
  }
  store.read(scaling_key::cut(scene.name), [&scene](const Json& variants) {
    for (const Json& variant : variants) {
      scene.what_ifs.push_back({member_of<std::string>(variant, "what"), member_of<double>(variant, "factor"),
                                member_of<Prediction>(variant, "predicted")});
    }
  });
}

void add_weak(const ScalingPlan& plan, const PointStore& store, SceneFindings& scene) {
  for (const int workers : plan.weak_workers(scene.name)) {
    WeakFindings& added = scene.weak.emplace_back();
    added.workers = workers;
    store.read(scaling_key::weak(scene.name, workers), [&added](const Json& point) {
      get_member(point, "objects", added.objects);
      if (point.contains("step_s")) added.measured_seconds = sum(member_of<std::vector<double>>(point, "step_s"));
      get_member(point, "predicted", added.predicted);
    });
  }
}

void take_checked(const Json& checked, SceneFindings& scene) {
  get_members(checked, "ok", scene.ok, "error", scene.error, "checksum", scene.checksum, "steps_checked",
              scene.steps_checked, "pairs", scene.pairs_checked);
}

void take_measured(const Json& measured, SceneFindings& scene) {
  get_members(measured, "objects", scene.objects, "steps", scene.steps, "events", scene.events, "stages", scene.stages);
  for (const Json& run : member_of<nlohmann::json>(measured, "runs"))
    scene.measured.push_back(measured_of(run, scene.checksum));
}

}  // namespace

double MeasuredThreads::balance() const {
  double mean = 0;
  double most = 0;
  for (const std::vector<double>& workers : busy) {
    mean += sum(workers) / static_cast<double>(workers.size());
    most += *std::max_element(workers.begin(), workers.end());
  }
  return most > 0 ? mean / most : 1;
}

bool SceneFindings::exact() const {
  return ok && std::all_of(measured.begin(), measured.end(), [](const auto& run) { return run.same_events; });
}

double SceneFindings::predicted_speedup(int workers, const std::string& forecast) const {
  return predicted.at(1).seconds(forecast) / predicted.at(workers).seconds(forecast);
}

std::vector<SceneFindings> scaling_findings(const ScalingPlan& plan, const PointStore& store) {
  std::vector<SceneFindings> scenes;
  for (const std::string& name : plan.scenes) {
    SceneFindings& scene = scenes.emplace_back();
    scene.name = name;
    store.read(scaling_key::checked(name), [&scene](const Json& point) { take_checked(point, scene); });
    store.read(scaling_key::measured(name), [&scene](const Json& point) { take_measured(point, scene); });
    store.read(scaling_key::memory(name), [&scene](const Json& point) { get_member(point, "shares", scene.memory); });
    for (const int workers : plan.simulate) {
      scene.predicted[workers] = store.get<Prediction>(scaling_key::predicted(name, workers));
    }
    add_what_ifs(plan, store, scene);
    if (plan.weak) add_weak(plan, store, scene);
    scene.timeline = store.read(scaling_key::timeline(name), timeline_of);
  }
  return scenes;
}

}  // namespace sweepgrid::study
