#include "study/accuracy/best_points.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace sweepgrid::study {
namespace {

constexpr double kPercent = 100;

double percent(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : kPercent * static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

double AccuracyPoint::missed_percent() const { return percent(accuracy.missed_pairs, accuracy.true_pairs); }
double AccuracyPoint::extra_percent() const { return percent(accuracy.extra_pairs, accuracy.reported_pairs); }

Spread AccuracyPoint::total_ms(double narrow_ns) const {
  constexpr double kMilliPerNano = 1e-6;
  const double narrow = kMilliPerNano * narrow_ns * candidates;
  return {step_ms.median + narrow, step_ms.low + narrow, step_ms.high + narrow};
}

std::vector<AccuracyPoint> points_of(const SceneResult& result, std::size_t truth) {
  std::vector<AccuracyPoint> points;
  for (const ConfigurationResult& one : result.configurations) {
    if (!one.given_up.empty()) continue;
    points.push_back({one.name, guarantee(find_configuration(one.name), result.truths[truth], one.violations),
                      spread(one.step_ms), one.accuracies[truth], one.candidates, one.violations});
  }
  return points;
}

std::vector<std::size_t> pareto_front(const std::vector<Place>& places) {
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return places[a].error != places[b].error ? places[a].error < places[b].error : places[a].cost < places[b].cost;
  });
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (places[i].cost >= least) continue;
    least = places[i].cost;
    front.push_back(i);
  }
  return front;
}

std::size_t cheapest_complete(const std::vector<AccuracyPoint>& points, double narrow_ns) {
  std::size_t best = points.size();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].accuracy.missed_pairs > 0) continue;
    if (best == points.size() || points[i].total_ms(narrow_ns).median < points[best].total_ms(narrow_ns).median) {
      best = i;
    }
  }
  return best;
}

}  // namespace sweepgrid::study
