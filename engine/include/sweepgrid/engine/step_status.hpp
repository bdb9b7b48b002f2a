#pragma once

namespace sweepgrid {

/// What became of a step().
enum class StepStatus {
  kDone,        ///< all that was queued is applied and reported
  kOverBudget,  ///< beyond Config::step_bytes: nothing of it is applied or reported, all of it is still queued
};

}  // namespace sweepgrid
