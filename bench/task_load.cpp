#include "task_load.hpp"

#include <algorithm>
#include <stdexcept>

namespace sweepgrid::bench {
namespace {

constexpr double kNano = 1e-9;

// How long at least one task ran.
double busy_seconds(const TaskTrace& trace) {
  std::vector<std::pair<std::int64_t, std::int64_t>> spans;
  spans.reserve(trace.size());
  for (const TaskRecord& task : trace) spans.emplace_back(task.start_ns, task.start_ns + task.duration_ns);
  std::sort(spans.begin(), spans.end());
  std::int64_t busy = 0;
  std::int64_t until = 0;
  for (const auto& [start, end] : spans) {
    busy += std::max<std::int64_t>(0, end - std::max(start, until));
    until = std::max(until, end);
  }
  return kNano * static_cast<double>(busy);
}

}  // namespace

void TaskLoad::add_run(const TaskTrace& trace, double queue_seconds, double step_seconds) {
  const double serial = step_seconds - busy_seconds(trace);
  if (tasks_.empty()) {
    for (const TaskRecord& task : trace) {
      tasks_.push_back({task.stage, task.size, kNano * static_cast<double>(task.duration_ns)});
    }
    serial_ = serial;
    queue_ = queue_seconds;
    return;
  }
  if (trace.size() != tasks_.size()) throw std::runtime_error("the tasks of a step differ from run to run");
  for (std::size_t i = 0; i < trace.size(); ++i) {
    Task& task = tasks_[i];
    if (trace[i].stage != task.stage || trace[i].size != task.size) {
      throw std::runtime_error("the tasks of a step differ from run to run");
    }
    task.seconds = std::min(task.seconds, kNano * static_cast<double>(trace[i].duration_ns));
  }
  serial_ = std::min(serial_, serial);
  queue_ = std::min(queue_, queue_seconds);
}

std::map<std::uint32_t, StageLoad> TaskLoad::stages() const {
  std::map<std::uint32_t, StageLoad> stages;
  for (const Task& task : tasks_) {
    StageLoad& stage = stages[task.stage];
    ++stage.tasks;
    stage.seconds += task.seconds;
    stage.longest = std::max(stage.longest, task.seconds);
  }
  return stages;
}

double TaskLoad::work_seconds() const {
  double seconds = 0;
  for (const Task& task : tasks_) seconds += task.seconds;
  return seconds;
}

}  // namespace sweepgrid::bench
