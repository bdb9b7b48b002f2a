#pragma once

#include <filesystem>

#include "study/report.hpp"

namespace sweepgrid::study {

struct ReportFiles {
  std::filesystem::path json;
  std::filesystem::path html;  ///< empty without has_report_page()
};

/// Writes study-<study>.json and study-<study>.html into `folder`, which is made where it is missing; each file appears
/// as a whole or not at all, the JSON first. A program without the page says so on stderr. Throws std::system_error.
ReportFiles write_report(const Report& report, const std::filesystem::path& folder);

}  // namespace sweepgrid::study
