#pragma once

#include <cstdint>
#include <memory>

#include <sweepgrid/sap/cell_kind.inl.hpp>

#include "sap_play.hpp"
#include "sap_replay.hpp"

namespace sweepgrid {

// These come from the library, so that what clients link is what is tested. The others are instantiated here.
extern template std::unique_ptr<SweepAndPrune<float, 2>> make_cell<float, 2>(const CellOptions&);
extern template std::unique_ptr<SweepAndPrune<float, 3>> make_cell<float, 3>(const CellOptions&);
extern template std::unique_ptr<SweepAndPrune<double, 2>> make_cell<double, 2>(const CellOptions&);
extern template std::unique_ptr<SweepAndPrune<double, 3>> make_cell<double, 3>(const CellOptions&);
extern template std::unique_ptr<SweepAndPrune<std::int16_t, 2>> make_cell<std::int16_t, 2>(const CellOptions&);
extern template std::unique_ptr<SweepAndPrune<std::int32_t, 3>> make_cell<std::int32_t, 3>(const CellOptions&);

namespace oracle {

template <class Scalar, int Dim>
std::string play_cell(const CellOptions& options, const Regime& regime, std::uint64_t seed) {
  return play<Scalar, Dim>([&options] { return make_cell<Scalar, Dim>(options); }, regime, seed);
}

}  // namespace oracle
}  // namespace sweepgrid
