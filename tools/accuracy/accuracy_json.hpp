#pragma once

#include <nlohmann/json_fwd.hpp>

#include "accuracy/accuracy_tally.hpp"

namespace sweepgrid::accuracy {

/// Every count by its name in Accuracy, with `recall` and `precision`; delays as `count`, `off_time`, `mean`, `most`
/// and `events`, a list of [delay, number].
[[nodiscard]] nlohmann::ordered_json accuracy_json(const Accuracy& accuracy);

}  // namespace sweepgrid::accuracy
