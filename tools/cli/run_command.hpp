#pragma once

#include "cli/run_options.hpp"

namespace sweepgrid {

/// `sweepgrid run`. False when a verification failed. Throws for what cannot be read, written or configured.
bool run_command(const RunOptions& options);

}  // namespace sweepgrid
