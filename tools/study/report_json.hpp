#pragma once

#include <nlohmann/json_fwd.hpp>

#include "study/report.hpp"

namespace sweepgrid::study {

/// Everything in the report, with this machine, this build and the time of the call; the fields are told in
/// tools/study/README.md. Numbers that JSON has no word for: NaN is null, infinities are "inf" and "-inf".
[[nodiscard]] nlohmann::ordered_json report_json(const Report& report);

}  // namespace sweepgrid::study
