#pragma once

#include <nlohmann/json_fwd.hpp>

namespace sweepgrid {

/// Where a result comes from, as every JSON file of this program tells it: fields as in BuildInfo and MachineInfo.
[[nodiscard]] nlohmann::ordered_json build_json();
[[nodiscard]] nlohmann::ordered_json machine_json();

}  // namespace sweepgrid
