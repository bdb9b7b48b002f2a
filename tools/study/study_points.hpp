#pragma once

#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "study/point_store.hpp"

namespace sweepgrid::study {

/// One thing to measure.
struct StudyPoint {
  std::string key;  ///< unique in its study; the user sees it, too
  double cost = 1;  ///< expected, in seconds on some machine; the remaining time is reckoned from it
  std::function<nlohmann::json()> measure;
};

/// Measures the points that `store` lacks, in order, and shows the progress. SIGINT or SIGTERM ends it after the point
/// at hand: throws Interrupted. A second signal ends the process; no finished point is lost.
/// Main thread only.
void measure_points(const std::string& title, const std::vector<StudyPoint>& points, PointStore& store);

}  // namespace sweepgrid::study
