#include <sweepgrid/engine/engine.hpp>

#include "system.hpp"

namespace sweepgrid::bench {
namespace {

class EngineSystem final : public System {
 public:
  EngineSystem(const Config<float, 3>& config, bool single_calls, std::uint32_t objects)
      : single_calls_(single_calls), engine_(config), handles_(objects) {}

  void queue(const ScriptStep& step) override {
    if (single_calls_) {
      queue_singly(step);
    } else {
      queue_in_bulk(step);
    }
  }

  void step() override {
    const auto& events = engine_.step();
    totals_.begins += events.begins.size();
    totals_.ends += events.ends.size();
  }

  [[nodiscard]] std::vector<ObjectPair> pairs() const override { return engine_.pairs(); }
  [[nodiscard]] std::optional<EventTotals> events() const override { return totals_; }
  [[nodiscard]] std::optional<std::uint64_t> counted_bytes() const override { return engine_.stats().bytes(); }

 private:
  void queue_singly(const ScriptStep& step) {
    for (const std::uint32_t object : step.erased) engine_.erase(handles_[object]);
    for (std::size_t i = 0; i < step.inserted.size(); ++i) {
      handles_[step.inserted[i]] = engine_.insert(step.inserted[i], step.inserted_boxes[i]);
    }
    for (std::size_t i = 0; i < step.updated.size(); ++i) {
      engine_.update(handles_[step.updated[i]], step.updated_boxes[i]);
    }
  }

  void queue_in_bulk(const ScriptStep& step) {
    if (!step.erased.empty()) engine_.erase(handles_of(step.erased));
    if (!step.inserted.empty()) {
      const auto handles = engine_.insert(step.inserted, step.inserted_boxes);
      for (std::size_t i = 0; i < handles.size(); ++i) handles_[step.inserted[i]] = handles[i];
    }
    if (!step.updated.empty()) engine_.update(handles_of(step.updated), step.updated_boxes);
  }

  // The client's own work, and timed as such: other systems look up their proxies, too.
  std::span<const Handle> handles_of(const std::vector<std::uint32_t>& objects) {
    chosen_.clear();
    for (const std::uint32_t object : objects) chosen_.push_back(handles_[object]);
    return chosen_;
  }

  bool single_calls_;
  Engine<float, 3, std::uint32_t> engine_;
  std::vector<Handle> handles_;  // by object number
  std::vector<Handle> chosen_;
  EventTotals totals_;
};

}  // namespace

std::unique_ptr<System> make_engine(const Config<float, 3>& config, bool single_calls, std::uint32_t objects) {
  return std::make_unique<EngineSystem>(config, single_calls, objects);
}

}  // namespace sweepgrid::bench
