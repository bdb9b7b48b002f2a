#pragma once

#include <string>
#include <vector>

#include "study/figures/figure_plans.hpp"
#include "study/study_options.hpp"

namespace sweepgrid::study {

/// What `sweepgrid study figures` was asked for.
struct FiguresOptions {
  StudyOptions study;
  std::vector<std::string> figures = {};  ///< of figure_numbers(); empty: all, and the measurements for other claims
};

/// The figures of the paper that are reproduced: "2", "8", "9", "10", "11".
[[nodiscard]] std::vector<std::string> figure_numbers();

/// Measures the paper's figures, holds its claims against them and writes the report "figures" into the folder.
/// False when a system's pairs were wrong: the report says where. Throws Interrupted, and std::exception for a folder
/// that cannot be written into.
[[nodiscard]] bool figures_study(const FiguresOptions& options);

/// The same with points of the caller's choice instead of figure_points().
[[nodiscard]] bool figures_study(const FiguresOptions& options, const std::vector<FigurePoint>& points);

}  // namespace sweepgrid::study
