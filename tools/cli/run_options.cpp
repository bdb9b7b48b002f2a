#include "cli/run_options.hpp"

namespace sweepgrid {

EngineSetup setup_of(const RunOptions& options) {
  if (options.setup) return *options.setup;
  EngineSetup setup;
  setup.treatment.door = options.scalar == ScalarKind::kDouble ? Door::kDouble : Door::kFloatNearest;
  if (options.cell) setup.config.cell.kind = *options.cell;
  if (options.segment_capacity) setup.config.cell.segment_capacity = *options.segment_capacity;
  setup.config.cell_size = options.cell_size;
  setup.config.cell_population = options.cell_population;
  if (options.reduction) setup.config.reduction = *options.reduction;
  if (options.step_method) setup.config.step_method = *options.step_method;
  return setup;
}

}  // namespace sweepgrid
