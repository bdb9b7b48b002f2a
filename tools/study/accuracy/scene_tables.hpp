#pragma once

#include <string>
#include <vector>

#include "study/accuracy/scene_result.hpp"
#include "study/report.hpp"

namespace sweepgrid::study {

/// For every truth, what each configuration guarantees, takes and reports. `id`: begins the tables' ids.
[[nodiscard]] std::vector<Table> scene_tables(const SceneResult& result, const std::string& id, double narrow_ns);

/// For every scene and truth the cheapest configurations that missed nothing, with and without a narrow phase.
[[nodiscard]] Table best_table(const std::vector<SceneResult>& results, double narrow_ns);

/// Promises that were not kept, a sentence each.
[[nodiscard]] Table broken_table(const std::vector<std::string>& broken);

}  // namespace sweepgrid::study
