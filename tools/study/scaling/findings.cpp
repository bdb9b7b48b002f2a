#include "study/scaling/findings.hpp"

#include <algorithm>
#include <numeric>

namespace sweepgrid::study {
namespace {

using Json = nlohmann::json;

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

MeasuredThreads measured_of(const Json& json, std::uint64_t checksum) {
  MeasuredThreads result;
  json.at("threads").get_to(result.threads);
  result.seconds = sum(json.at("step_s"));
  json.at("round_s").get_to(result.round_seconds);
  json.at("part_s").get_to(result.part_seconds);
  json.at("busy_s").get_to(result.busy);
  json.at("predicted").get_to(result.predicted);
  json.at("replayed").get_to(result.replayed);
  for (const std::uint64_t found : json.at("checksums").get<std::vector<std::uint64_t>>()) {
    result.same_events = result.same_events && found == checksum;
  }
  return result;
}

TimelineFindings timeline_of(const Json& json) {
  TimelineFindings result;
  json.at("workers").get_to(result.workers);
  json.at("stages").get_to(result.stages);
  for (const Json& task : json.at("tasks")) {
    result.tasks.push_back({task.at(0), task.at(1), task.at(2), task.at(3), task.at(4)});
  }
  return result;
}

void add_what_ifs(const ScalingPlan& plan, const PointStore& store, SceneFindings& scene) {
  scene.what_if_workers = plan.what_if_workers;
  for (const int population : plan.populations) {
    const Json& point = *store.find(scaling_key::population(scene.name, population));
    scene.what_ifs.push_back({"population", static_cast<double>(population), point.get<Prediction>()});
  }
  for (const Json& variant : *store.find(scaling_key::cut(scene.name))) {
    scene.what_ifs.push_back({variant.at("what"), variant.at("factor"), variant.at("predicted").get<Prediction>()});
  }
}

void add_weak(const ScalingPlan& plan, const PointStore& store, SceneFindings& scene) {
  for (const int workers : plan.weak_workers(scene.name)) {
    const Json& point = *store.find(scaling_key::weak(scene.name, workers));
    WeakFindings& added = scene.weak.emplace_back();
    added.workers = workers;
    point.at("objects").get_to(added.objects);
    if (point.contains("step_s")) added.measured_seconds = sum(point.at("step_s"));
    point.at("predicted").get_to(added.predicted);
  }
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
    const Json& checked = *store.find(scaling_key::checked(name));
    checked.at("ok").get_to(scene.ok);
    checked.at("error").get_to(scene.error);
    checked.at("checksum").get_to(scene.checksum);
    checked.at("steps_checked").get_to(scene.steps_checked);
    checked.at("pairs").get_to(scene.pairs_checked);
    const Json& measured = *store.find(scaling_key::measured(name));
    measured.at("objects").get_to(scene.objects);
    measured.at("steps").get_to(scene.steps);
    measured.at("events").get_to(scene.events);
    measured.at("stages").get_to(scene.stages);
    for (const Json& run : measured.at("runs")) scene.measured.push_back(measured_of(run, scene.checksum));
    store.find(scaling_key::memory(name))->at("shares").get_to(scene.memory);
    for (const int workers : plan.simulate) {
      scene.predicted[workers] = store.find(scaling_key::predicted(name, workers))->get<Prediction>();
    }
    add_what_ifs(plan, store, scene);
    if (plan.weak) add_weak(plan, store, scene);
    scene.timeline = timeline_of(*store.find(scaling_key::timeline(name)));
  }
  return scenes;
}

}  // namespace sweepgrid::study
