#include <sweepgrid/scheduler/work_graph.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sweepgrid {
namespace {

bool is_time(double seconds) { return std::isfinite(seconds) && seconds >= 0; }

void require_valid(const WorkStage& stage, std::size_t id) {
  const auto refuse = [&](const char* what) {
    throw std::invalid_argument("stage " + std::to_string(id) + " '" + stage.name + "': " + what);
  };
  if (!is_time(stage.serial)) refuse("the serial part is no time");
  for (const WorkTask& task : stage.tasks) {
    if (!is_time(task.seconds)) refuse("a task's time is no time");
    if (!(task.memory_share >= 0 && task.memory_share <= 1)) refuse("a memory share is not within 0 and 1");
  }
  for (const std::uint32_t earlier : stage.after) {
    if (earlier >= id) refuse("it waits for a stage that is not an earlier one");
  }
}

}  // namespace

WorkAndSpan work_and_span(const WorkGraph& graph) {
  WorkAndSpan result;
  std::vector<double> ends;  // of stages, on a machine with workers without end
  for (std::size_t id = 0; id < graph.size(); ++id) {
    const WorkStage& stage = graph[id];
    require_valid(stage, id);
    double start = 0;
    for (const std::uint32_t earlier : stage.after) start = std::max(start, ends[earlier]);
    double longest = 0;
    result.work += stage.serial;
    result.serial += stage.serial;
    for (const WorkTask& task : stage.tasks) {
      result.work += task.seconds;
      longest = std::max(longest, task.seconds);
    }
    ends.push_back(start + stage.serial + longest);
    result.span = std::max(result.span, ends.back());
  }
  return result;
}

}  // namespace sweepgrid
