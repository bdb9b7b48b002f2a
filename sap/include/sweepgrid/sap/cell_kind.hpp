#pragma once

#include <memory>

#include <sweepgrid/sap/cell_options.hpp>
#include <sweepgrid/sap/sweep_and_prune.hpp>

namespace sweepgrid {

/// A new empty cell. Throws std::invalid_argument for a segment capacity out of its range.
template <class Scalar, int Dim>
[[nodiscard]] std::unique_ptr<SweepAndPrune<Scalar, Dim>> make_cell(const CellOptions& options);

}  // namespace sweepgrid
