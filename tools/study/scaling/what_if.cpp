#include "study/scaling/what_if.hpp"

#include <algorithm>
#include <map>

#include "study/scaling/run.hpp"

namespace sweepgrid::study {
namespace {

// Every `count` neighbours become one task.
std::vector<WorkGraph> coarser(std::vector<WorkGraph> steps, std::size_t count) {
  for (WorkGraph& graph : steps) {
    for (WorkStage& stage : graph) {
      std::vector<WorkTask> tasks;
      for (std::size_t i = 0; i < stage.tasks.size(); ++i) {
        if (i % count == 0) tasks.emplace_back();
        tasks.back().seconds += stage.tasks[i].seconds;
        tasks.back().size += stage.tasks[i].size;
      }
      stage.tasks = std::move(tasks);
    }
  }
  return steps;
}

// `steps`, but with the stage `gather` of `other`.
std::vector<WorkGraph> with_gather_of(std::vector<WorkGraph> steps, const std::vector<WorkGraph>& other) {
  for (std::size_t step = 0; step < steps.size(); ++step) {
    const auto gather = [](const WorkStage& stage) { return stage.name == "gather"; };
    const auto to = std::find_if(steps[step].begin(), steps[step].end(), gather);
    const auto from = std::find_if(other[step].begin(), other[step].end(), gather);
    if (to == steps[step].end() || from == other[step].end()) continue;
    to->serial = from->serial;
    to->tasks = from->tasks;
  }
  return steps;
}

}  // namespace

std::vector<CutVariant> cut_variants(const SceneScript& scene, int workers, int runs) {
  std::map<int, std::vector<WorkGraph>> cut_for;
  for (const int cut : {workers / 4, workers / 2, workers, 2 * workers, 4 * workers}) {
    if (cut >= 1) cut_for[cut] = record_work(scene, {}, cut, runs);
  }
  const std::vector<WorkGraph>& own = cut_for[workers];
  std::vector<CutVariant> variants;
  variants.push_back({"grain", 0.25, cut_for[4 * workers]});
  variants.push_back({"grain", 0.5, cut_for[2 * workers]});
  for (const std::size_t count : {1, 2, 4, 8}) {
    variants.push_back({"grain", static_cast<double>(count), coarser(own, count)});
  }
  for (const auto& [cut, steps] : cut_for) {
    variants.push_back({"shards", static_cast<double>(cut) / workers, with_gather_of(own, steps)});
  }
  return variants;
}

}  // namespace sweepgrid::study
