#pragma once

#include "cli/run_options.hpp"

namespace sweepgrid {

/// `sweepgrid run`. False when a verification failed. Throws for what cannot be read, written or configured; where a
/// scene could not be read to its end, after the results of all steps before that and of the other scenes are written.
bool run_command(const RunOptions& options);

}  // namespace sweepgrid
