#pragma once

#include <cstdint>
#include <string>

#include <sweepgrid/sap/cell_kind.hpp>

#include "op_script.hpp"

namespace sweepgrid::oracle {

/// Plays a script to a new cell of the kind in `options`; see play() in sap_replay.hpp. Compiled once for each scalar
/// and dimension that the tests know, in sap_play_*.cpp.
template <class Scalar, int Dim>
std::string play_cell(const CellOptions& options, const Regime& regime, std::uint64_t seed);

}  // namespace sweepgrid::oracle
