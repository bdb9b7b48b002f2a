#pragma once

#include "study/report.hpp"

namespace sweepgrid::study {

/// Tries to end the script that holds it, to begin an element and a comment, to leave an attribute, and is not ASCII.
inline constexpr const char* kHostile = "</script><b onclick='x'>\"&amp;<!-- \\u003c ½ 場";

/// Every kind of chart, table and series, all that may be absent, numbers that JSON cannot hold, and hostile texts.
/// The numbers are made up. A timeline of `tasks` tasks.
[[nodiscard]] Report sample_report(std::size_t tasks);

}  // namespace sweepgrid::study
