#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "measure/spread.hpp"
#include "study/accuracy/scene_result.hpp"

namespace sweepgrid::study {

/// A configuration of a scene beside one of its truths: a point of the charts.
struct AccuracyPoint {
  std::string name;
  Guarantee guarantee = Guarantee::kMayMiss;
  Spread step_ms;  ///< over the rounds
  accuracy::Accuracy accuracy;
  double candidates = 0;
  std::uint64_t violations = 0;

  /// Parts that missed and extra pairs are of the true and of the reported ones, in per cent.
  [[nodiscard]] double missed_percent() const;
  [[nodiscard]] double extra_percent() const;
  /// A step together with a narrow phase that takes `narrow_ns` for each reported pair; ms.
  [[nodiscard]] Spread total_ms(double narrow_ns) const;
};

/// All that were not given up, in the order of configurations(). `truth`: index into SceneResult::truths.
[[nodiscard]] std::vector<AccuracyPoint> points_of(const SceneResult& result, std::size_t truth);

/// A point's place: how wrong, how dear.
struct Place {
  double error = 0;
  double cost = 0;
};

/// Indices of the places that no other beats: none is as good in both and better in one. By growing error; of equal
/// places the first.
[[nodiscard]] std::vector<std::size_t> pareto_front(const std::vector<Place>& places);

/// Index of the point with the least total that missed nothing; points.size() when all missed something.
[[nodiscard]] std::size_t cheapest_complete(const std::vector<AccuracyPoint>& points, double narrow_ns);

}  // namespace sweepgrid::study
