#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <sweepgrid/engine/engine.hpp>

#include "baselines/peer_system.hpp"

namespace sweepgrid::accuracy {

using baselines::EventTotals;
using baselines::ObjectPair;

/// The engine as a client uses it: by handle, and in bulk.
class EngineSystem final : public baselines::System {
 public:
  /// `single_calls`: one call for every object rather than one for all.
  EngineSystem(const Config& config, bool single_calls, std::uint32_t objects)
      : single_calls_(single_calls), engine_(config), handles_(objects) {}

  void queue(const ScriptStep& step) override;
  void step() override;

  [[nodiscard]] std::vector<ObjectPair> pairs() const override { return engine_.pairs(); }
  [[nodiscard]] bool refused() const override { return engine_.status() == StepStatus::kOverBudget; }
  [[nodiscard]] std::optional<EventTotals> events() const override { return totals_; }
  [[nodiscard]] std::optional<std::uint64_t> counted_bytes() const override { return engine_.stats().bytes(); }

  [[nodiscard]] Engine<float, 3, std::uint32_t>& engine() { return engine_; }

 private:
  void queue_singly(const ScriptStep& step);
  void queue_in_bulk(const ScriptStep& step);
  std::span<const Handle> handles_of(const std::vector<std::uint32_t>& objects);

  bool single_calls_;
  Engine<float, 3, std::uint32_t> engine_;
  std::vector<Handle> handles_;  // by object number
  std::vector<Handle> chosen_;
  EventTotals totals_;
};

}  // namespace sweepgrid::accuracy
