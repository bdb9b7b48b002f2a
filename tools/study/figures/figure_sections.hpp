#pragma once

#include "study/figures/results.hpp"
#include "study/report.hpp"

namespace sweepgrid::study {

/// A section for every figure that was measured, those of the paper first.
[[nodiscard]] std::vector<Section> figure_sections(const Results& results);

/// Which runs were held against the oracle, and what was found.
[[nodiscard]] Section exactness_section(const Results& results);

/// Whether no system's pairs were wrong.
[[nodiscard]] bool all_exact(const Results& results);

}  // namespace sweepgrid::study
