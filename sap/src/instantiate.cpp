#include <stdexcept>

#include <sweepgrid/sap/cell_kind.inl.hpp>

namespace sweepgrid {

template std::unique_ptr<SweepAndPrune<float, 2>> make_cell<float, 2>(const CellOptions&);
template std::unique_ptr<SweepAndPrune<float, 3>> make_cell<float, 3>(const CellOptions&);
template std::unique_ptr<SweepAndPrune<double, 2>> make_cell<double, 2>(const CellOptions&);
template std::unique_ptr<SweepAndPrune<double, 3>> make_cell<double, 3>(const CellOptions&);

}  // namespace sweepgrid
