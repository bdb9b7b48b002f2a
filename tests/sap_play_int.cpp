#include <cstdint>

#include "sap_play.inl.hpp"

namespace sweepgrid::oracle {

template std::string play_cell<std::int32_t, 3>(const CellOptions&, const Regime&, std::uint64_t);
template std::string play_cell<std::int16_t, 2>(const CellOptions&, const Regime&, std::uint64_t);

}  // namespace sweepgrid::oracle
