#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace sweepgrid::study {

/// Whether this program holds the page; without (built with SWEEPGRID_BUILD_REPORT=OFF), reports are JSON alone.
[[nodiscard]] bool has_report_page();

/// One page that shows the report, needs no other file and no network, and carries the JSON in it. `report`: of
/// report_json(). Throws std::logic_error without has_report_page().
[[nodiscard]] std::string report_html(const nlohmann::ordered_json& report);

}  // namespace sweepgrid::study
