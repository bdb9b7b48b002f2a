#pragma once

#include <string>

#include "accuracy/truth.hpp"
#include "scenes/scene_source.hpp"
#include "setup/engine_setup.hpp"

namespace sweepgrid {

/// What is promised of the pairs after every step.
enum class Guarantee { kExact, kSuperset, kMayMiss };

/// "exact", "superset only", "may miss".
[[nodiscard]] std::string guarantee_name(Guarantee guarantee);

/// What a setup promises of a truth of a scene (engine/ACCURACY.md). `outside`: boxes may leave, or have left, what the
/// latest query covered, which breaks the promise of strides that only report it. Superset, not exact, wherever that
/// depends on the scene's numbers.
[[nodiscard]] Guarantee guarantee(const EngineSetup& setup, const SceneInfo& scene, accuracy::TruthKind truth,
                                  bool outside);

}  // namespace sweepgrid
