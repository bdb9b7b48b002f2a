#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <sweepgrid/engine/envelope_options.hpp>
#include <sweepgrid/engine/events.hpp>
#include <sweepgrid/engine/stats.hpp>

#include "scenes/scene_source.hpp"
#include "setup/engine_setup.hpp"
#include "study/accuracy/configurations.hpp"
#include "study/accuracy/known_scene.hpp"

namespace sweepgrid::study {

/// What came of playing a scene.
struct Play {
  double step_ms = 0;            ///< time of a step after the start, the mean
  std::vector<double> times_ms;  ///< of all steps, the start first
  EnvelopeReport report;
  Stats stats;  ///< after the last step
};

/// Gets the events of every step, the start included; false ends the play.
using Listener = std::function<bool(const Events<SceneKey>&)>;

/// Plays a scene to a new engine. A step's time is from the scene's boxes at hand to the events at hand: with their
/// conversion, without `listen`. Processor time with one thread, else wall time. Throws what Engine's constructor
/// throws.
Play play(const EngineSetup& setup, const KnownScene& scene, const Listener& listen);

/// What a configuration is in a scene: one thread, all three axes.
[[nodiscard]] EngineSetup setup_of(const Configuration& configuration, const KnownScene& scene);
Play play(const Configuration& configuration, const KnownScene& scene, const Listener& listen);

}  // namespace sweepgrid::study
