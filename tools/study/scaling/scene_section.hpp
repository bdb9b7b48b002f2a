#pragma once

#include <string>

#include "study/report.hpp"
#include "study/scaling/findings.hpp"

namespace sweepgrid::study {

/// What was found of one scene: measured and simulated speed-ups, where the time goes on many workers, what other
/// settings would do, a timeline. `index`: of the scene, for the ids of charts.
[[nodiscard]] Section scene_section(const SceneFindings& scene, std::size_t index);

}  // namespace sweepgrid::study
