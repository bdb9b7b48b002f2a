#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <sweepgrid/engine/envelope_options.hpp>
#include <sweepgrid/engine/events.hpp>
#include <sweepgrid/engine/handle.hpp>
#include <sweepgrid/engine/stats.hpp>

#include "scenes/scene_source.hpp"
#include "setup/engine_setup.hpp"

namespace sweepgrid {

/// An engine of whatever type a setup asks for, for the boxes of a scene. A step is convert(), queue(), step(), so that
/// each can be timed by itself.
class SceneEngine {
 public:
  virtual ~SceneEngine() = default;

  /// Takes the boxes of the next step over into the engine's precision and axes.
  virtual void convert(std::span<const SceneBox> inserted, std::span<const SceneBox> updated) = 0;
  /// Queues the next step, with the boxes that were converted last; returns the handles of `inserted`. In bulk.
  /// Throws what Engine's calls throw.
  virtual std::vector<Handle> queue(std::span<const Handle> erased, std::span<const SceneKey> inserted,
                                    std::span<const Handle> updated) = 0;
  /// Throws std::length_error when the engine refuses the step: a scene must not be played with a step left out.
  virtual const Events<SceneKey>& step() = 0;

  /// Writes over boxes what became of them: in the engine's units, axes that it has not being [0, 0].
  virtual void as_taken(std::vector<SceneBox>& boxes) const = 0;

  [[nodiscard]] virtual std::vector<Pair<SceneKey>> pairs() const = 0;
  [[nodiscard]] virtual std::size_t size() const = 0;
  [[nodiscard]] virtual Stats stats() const = 0;
  [[nodiscard]] virtual EnvelopeReport envelope_report() const = 0;
};

/// `dim`: of the scene. Throws what Engine's constructor throws.
[[nodiscard]] std::unique_ptr<SceneEngine> make_scene_engine(const EngineSetup& setup, int dim);

}  // namespace sweepgrid
