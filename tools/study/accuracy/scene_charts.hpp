#pragma once

#include <string>
#include <vector>

#include "study/accuracy/scene_result.hpp"
#include "study/report.hpp"

namespace sweepgrid::study {

/// For every truth, time over missed and over extra pairs, and the total with a narrow phase over missed pairs; then
/// the total over the price of the narrow phase. `id`: begins the charts' ids. `narrow_ns`: the price of a pair.
[[nodiscard]] std::vector<LineChart> scene_charts(const SceneResult& result, const std::string& id, double narrow_ns);

}  // namespace sweepgrid::study
