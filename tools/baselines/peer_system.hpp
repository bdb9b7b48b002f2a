#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <sweepgrid/engine/events.hpp>

#include "scenes/scene_script.hpp"

namespace sweepgrid::baselines {

/// Numbers of two objects, in any order.
using ObjectPair = Pair<std::uint32_t>;

struct EventTotals {
  std::uint64_t begins = 0;
  std::uint64_t ends = 0;

  friend bool operator==(const EventTotals&, const EventTotals&) = default;
};

/// A broad phase that is timed. queue() and step() together are a step: from being told what changed to having the
/// events at hand or, in a system without events, all overlapping pairs.
class System {
 public:
  virtual ~System() = default;

  /// Tells what changes. A system that has no queue applies it at once.
  virtual void queue(const ScriptStep& step) = 0;

  /// Finds what the changes have led to.
  virtual void step() = 0;

  /// Overlapping pairs as of the latest step, in any order. Not timed.
  [[nodiscard]] virtual std::vector<ObjectPair> pairs() const = 0;

  /// Whether the latest step was refused for want of memory, and everything is as it was before it.
  [[nodiscard]] virtual bool refused() const { return false; }

  /// Events so far; absent when the system has none.
  [[nodiscard]] virtual std::optional<EventTotals> events() const { return std::nullopt; }

  /// Bytes by the system's own account; absent when it keeps none.
  [[nodiscard]] virtual std::optional<std::uint64_t> counted_bytes() const { return std::nullopt; }
};

/// Makes a system for objects whose numbers are below `objects`.
using SystemMaker = std::function<std::unique_ptr<System>(std::uint32_t objects)>;

}  // namespace sweepgrid::baselines
