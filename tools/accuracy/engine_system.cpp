#include "accuracy/engine_system.hpp"

namespace sweepgrid::accuracy {

void EngineSystem::queue(const ScriptStep& step) {
  if (single_calls_) {
    queue_singly(step);
  } else {
    queue_in_bulk(step);
  }
}

void EngineSystem::step() {
  const auto& events = engine_.step();
  totals_.begins += events.begins.size();
  totals_.ends += events.ends.size();
}

void EngineSystem::queue_singly(const ScriptStep& step) {
  for (const std::uint32_t object : step.erased) engine_.erase(handles_[object]);
  for (std::size_t i = 0; i < step.inserted.size(); ++i) {
    handles_[step.inserted[i]] = engine_.insert(step.inserted[i], step.inserted_boxes[i]);
  }
  for (std::size_t i = 0; i < step.updated.size(); ++i) {
    engine_.update(handles_[step.updated[i]], step.updated_boxes[i]);
  }
}

void EngineSystem::queue_in_bulk(const ScriptStep& step) {
  if (!step.erased.empty()) engine_.erase(handles_of(step.erased));
  if (!step.inserted.empty()) {
    const auto handles = engine_.insert(step.inserted, step.inserted_boxes);
    for (std::size_t i = 0; i < handles.size(); ++i) handles_[step.inserted[i]] = handles[i];
  }
  if (!step.updated.empty()) engine_.update(handles_of(step.updated), step.updated_boxes);
}

// The client's own work, and timed as such: other systems look up their proxies, too.
std::span<const Handle> EngineSystem::handles_of(const std::vector<std::uint32_t>& objects) {
  chosen_.clear();
  for (const std::uint32_t object : objects) chosen_.push_back(handles_[object]);
  return chosen_;
}

}  // namespace sweepgrid::accuracy
