#pragma once

#include <string>

#include "study/figures/figure_plans.hpp"

/// Systems that the paper's claims compare, by name.
namespace sweepgrid::study::claimed {

inline const std::string kClassicCell = system_name::one_cell(CellKind::kClassic);
inline const std::string kBatchCell = system_name::one_cell(CellKind::kBatch);
inline const std::string kSegmentedCell = system_name::one_cell(CellKind::kSegmented);
inline const std::string kClassicGrid = system_name::grid(CellKind::kClassic);
inline const std::string kBatchGrid = system_name::grid(CellKind::kBatch);
inline const std::string kSegmentedGrid = system_name::grid(CellKind::kSegmented);

/// From so many objects on a grid has cells with neighbours on all sides.
inline constexpr double kLeastGrid = 8000;

}  // namespace sweepgrid::study::claimed
