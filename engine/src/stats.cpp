#include <sweepgrid/engine/stats.hpp>

namespace sweepgrid {

StepCounters& StepCounters::operator+=(const StepCounters& other) {
  cells += other.cells;
  inserts += other.inserts;
  updates += other.updates;
  erases += other.erases;
  migrations += other.migrations;
  sweeps += other.sweeps;
  cell_ops += other.cell_ops;
  cells_drained += other.cells_drained;
  regrids += other.regrids;
  begins += other.begins;
  ends += other.ends;
  return *this;
}

}  // namespace sweepgrid
