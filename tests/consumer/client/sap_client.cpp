// One cell without grid, threads or engine.
#include <vector>

#include <sweepgrid/sap/cell_kind.hpp>

int main() {
  using Cell = sweepgrid::SweepAndPrune<float, 2>;
  const auto cell = sweepgrid::make_cell<float, 2>({});
  sweepgrid::DeltaList deltas;
  sweepgrid::SapCounters counters;
  cell->drain(std::vector<Cell::Op>{}, deltas, counters);
  return deltas.empty() && cell->size() == 0 ? 0 : 1;
}
