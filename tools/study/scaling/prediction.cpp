#include "study/scaling/prediction.hpp"

#include <algorithm>
#include <numeric>

#include "setup/json_text.hpp"

namespace sweepgrid::study {
namespace {

StageForecast& stage_named(std::vector<StageForecast>& stages, const std::string& name) {
  const auto found = std::find_if(stages.begin(), stages.end(), [&](const auto& stage) { return stage.name == name; });
  if (found != stages.end()) return *found;
  stages.push_back({name, 0, 0, 0, 0, 0});
  return stages.back();
}

void set_memory_shares(WorkGraph& graph, const MemoryShares& shares) {
  for (WorkStage& stage : graph) {
    const auto share = shares.find(stage.name);
    if (share == shares.end()) continue;
    for (WorkTask& task : stage.tasks) task.memory_share = share->second;
  }
}

void add_stages(const WorkGraph& graph, const Schedule& schedule, std::size_t steps,
                std::vector<StageForecast>& stages) {
  double before = 0;
  for (std::size_t s = 0; s < graph.size(); ++s) {
    StageForecast& stage = stage_named(stages, graph[s].name);
    double longest = 0;
    for (const WorkTask& task : graph[s].tasks) {
      stage.work += task.seconds;
      longest = std::max(longest, task.seconds);
    }
    stage.serial += graph[s].serial;
    stage.longest += longest;
    stage.tasks += static_cast<double>(graph[s].tasks.size()) / static_cast<double>(steps);
    stage.wall += schedule.stages[s].end - before;
    before = schedule.stages[s].end;
  }
}

}  // namespace

double Prediction::seconds(const std::string& forecast) const {
  const std::vector<double>& steps = step_seconds.at(forecast);
  return std::accumulate(steps.begin(), steps.end(), 0.0);
}

Prediction predict(std::vector<WorkGraph> steps, int workers, const MachineCosts& costs, const MemoryShares& shares) {
  Prediction result;
  result.workers = workers;
  for (WorkGraph& graph : steps) {
    set_memory_shares(graph, shares);
    const WorkAndSpan bounds = work_and_span(graph);
    result.work += bounds.work;
    result.span += bounds.span;
    result.serial += bounds.serial;
    for (const Forecast& forecast : kForecasts) {
      const Schedule schedule = simulate(graph, workers, forecast.policy, costs.schedule_costs(forecast.memory));
      result.step_seconds[forecast.id].push_back(schedule.makespan);
      if (&forecast == &kForecasts.front()) add_stages(graph, schedule, steps.size(), result.stages);
    }
  }
  return result;
}

void to_json(nlohmann::json& out, const Prediction& prediction) {
  nlohmann::json stages = nlohmann::json::array();
  for (const StageForecast& stage : prediction.stages) {
    stages.push_back({{"name", stage.name},
                      {"work_s", stage.work},
                      {"serial_s", stage.serial},
                      {"wall_s", stage.wall},
                      {"longest_s", stage.longest},
                      {"tasks", stage.tasks}});
  }
  out = {{"workers", prediction.workers}, {"work_s", prediction.work},   {"span_s", prediction.span},
         {"serial_s", prediction.serial}, {"stages", std::move(stages)}, {"step_s", prediction.step_seconds}};
}

void from_json(const nlohmann::json& in, Prediction& prediction) {
  get_member(in, "workers", prediction.workers);
  get_member(in, "work_s", prediction.work);
  get_member(in, "span_s", prediction.span);
  get_member(in, "serial_s", prediction.serial);
  get_member(in, "step_s", prediction.step_seconds);
  prediction.stages.clear();
  for (const auto& stage : member_of<nlohmann::json>(in, "stages")) {
    prediction.stages.push_back({member_of<std::string>(stage, "name"), member_of<double>(stage, "work_s"),
                                 member_of<double>(stage, "serial_s"), member_of<double>(stage, "wall_s"),
                                 member_of<double>(stage, "longest_s"), member_of<double>(stage, "tasks")});
  }
}

}  // namespace sweepgrid::study
