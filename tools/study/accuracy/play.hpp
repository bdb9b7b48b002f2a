#pragma once

#include <cstdint>
#include <functional>

#include <sweepgrid/engine/envelope_options.hpp>
#include <sweepgrid/engine/events.hpp>

#include "scenes/scene_source.hpp"
#include "study/accuracy/configurations.hpp"
#include "study/accuracy/known_scene.hpp"

namespace sweepgrid::study {

/// What came of playing a scene.
struct Play {
  double step_ms = 0;  ///< processor time of a step after the start, the mean
  EnvelopeReport report;
};

/// Gets the events of every step, the start included; false ends the play.
using Listener = std::function<bool(const Events<SceneKey>&)>;

/// Plays a scene to a new engine on one thread. A step's time is from the scene's boxes at hand to the events at hand:
/// with their conversion, without `listen`. Throws what Engine's constructor throws.
Play play(const Configuration& configuration, const KnownScene& scene, const Listener& listen);

}  // namespace sweepgrid::study
