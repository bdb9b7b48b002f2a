#include <chrono>

#include <sweepgrid/engine/engine.hpp>

#include "system.hpp"

namespace sweepgrid::bench {
namespace {

class EngineSystem final : public System {
 public:
  EngineSystem(const Config<float, 3>& config, std::uint32_t objects) : engine_(config), handles_(objects) {}

  void step(const ScriptStep& step) override {
    for (const std::uint32_t object : step.erased) engine_.erase(handles_[object]);
    if (!step.inserted.empty()) {
      const auto handles = engine_.insert(step.inserted, step.inserted_boxes);
      for (std::size_t i = 0; i < handles.size(); ++i) handles_[step.inserted[i]] = handles[i];
    }
    for (std::size_t i = 0; i < step.updated.size(); ++i) {
      engine_.update(handles_[step.updated[i]], step.updated_boxes[i]);
    }
    const auto start = std::chrono::steady_clock::now();
    const auto& events = engine_.step();
    step_only_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    begins_ += events.begins.size();
    ends_ += events.ends.size();
  }

  [[nodiscard]] double step_only_seconds() const override { return step_only_; }
  [[nodiscard]] std::uint64_t pairs() const override { return engine_.stats().pairs; }
  [[nodiscard]] std::uint64_t begins() const override { return begins_; }
  [[nodiscard]] std::uint64_t ends() const override { return ends_; }
  [[nodiscard]] std::uint64_t bytes() const override { return engine_.stats().bytes(); }

 private:
  Engine<float, 3, std::uint32_t> engine_;
  std::vector<Handle> handles_;  // by object number
  double step_only_ = 0;
  std::uint64_t begins_ = 0;
  std::uint64_t ends_ = 0;
};

}  // namespace

std::unique_ptr<System> make_engine(const Config<float, 3>& config, std::uint32_t objects) {
  return std::make_unique<EngineSystem>(config, objects);
}

}  // namespace sweepgrid::bench
