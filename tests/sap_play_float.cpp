#include "sap_play.inl.hpp"

namespace sweepgrid::oracle {

template std::string play_cell<float, 2>(const CellOptions&, const Regime&, std::uint64_t);
template std::string play_cell<float, 3>(const CellOptions&, const Regime&, std::uint64_t);

}  // namespace sweepgrid::oracle
