#include <cstdint>

#include "sap_play.inl.hpp"

// What is not compiled ahead.
namespace sweepgrid::oracle {

template std::string play_cell<float, 1>(const CellOptions&, const Regime&, std::uint64_t);
template std::string play_cell<float, 4>(const CellOptions&, const Regime&, std::uint64_t);
template std::string play_cell<std::int32_t, 1>(const CellOptions&, const Regime&, std::uint64_t);
template std::string play_cell<std::uint32_t, 2>(const CellOptions&, const Regime&, std::uint64_t);

}  // namespace sweepgrid::oracle
