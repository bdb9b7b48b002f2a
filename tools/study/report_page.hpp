#pragma once

#include <string_view>

namespace sweepgrid::study {

/// The page without a report: what tools/report is bundled into. Empty in a program without it.
extern const std::string_view kReportPage;

}  // namespace sweepgrid::study
