#pragma once

#include <string>
#include <vector>

#include "cli/run_options.hpp"
#include "cli/scene_run.hpp"

namespace sweepgrid {

/// Everything that is known of a run, as JSON text. The fields are told in tools/README.md; `schema_version` grows when
/// one changes its meaning or goes.
[[nodiscard]] std::string run_json(const RunOptions& options, int workers, const std::vector<SceneResult>& results);

}  // namespace sweepgrid
