#include <cstdint>
#include <stdexcept>

#include <sweepgrid/sap/cell_kind.inl.hpp>

namespace sweepgrid {

template std::unique_ptr<SweepAndPrune<std::int32_t, 2>> make_cell<std::int32_t, 2>(const CellOptions&);
template std::unique_ptr<SweepAndPrune<std::int32_t, 3>> make_cell<std::int32_t, 3>(const CellOptions&);
template std::unique_ptr<SweepAndPrune<std::int16_t, 2>> make_cell<std::int16_t, 2>(const CellOptions&);
template std::unique_ptr<SweepAndPrune<std::int16_t, 3>> make_cell<std::int16_t, 3>(const CellOptions&);

}  // namespace sweepgrid
