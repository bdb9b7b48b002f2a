#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <sweepgrid/engine/config.hpp>
#include <sweepgrid/sap/box.hpp>

namespace sweepgrid::bench {

using FloatBox = Box<float, 3>;

/// One step of a scene, with objects numbered densely: number k is always the same object while it lives.
struct ScriptStep {
  std::vector<std::uint32_t> erased;
  std::vector<std::uint32_t> inserted;
  std::vector<FloatBox> inserted_boxes;
  std::vector<std::uint32_t> updated;
  std::vector<FloatBox> updated_boxes;
};

/// A broad phase that is timed: everything from being told what changed to having counted the events.
class System {
 public:
  virtual ~System() = default;

  /// Applies one step and finds the events.
  virtual void step(const ScriptStep& step) = 0;

  /// Seconds of the latest step after queueing was done; what is parallel at all is in here.
  [[nodiscard]] virtual double step_only_seconds() const = 0;

  /// Overlapping pairs now, and events so far.
  [[nodiscard]] virtual std::uint64_t pairs() const = 0;
  [[nodiscard]] virtual std::uint64_t begins() const = 0;
  [[nodiscard]] virtual std::uint64_t ends() const = 0;

  /// Bytes by the system's own account; 0 where it keeps none.
  [[nodiscard]] virtual std::uint64_t bytes() const { return 0; }
};

/// `objects`: numbers are below this.
[[nodiscard]] std::unique_ptr<System> make_engine(const Config<float, 3>& config, std::uint32_t objects);

/// btDbvtBroadphase with exact boxes (no margin) and events from the pair cache's callback: the fastest exact setting.
[[nodiscard]] std::unique_ptr<System> make_bullet(std::uint32_t objects);

}  // namespace sweepgrid::bench
