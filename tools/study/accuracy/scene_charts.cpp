#include "study/accuracy/scene_charts.hpp"

#include <cmath>
#include <functional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "study/accuracy/best_points.hpp"

namespace sweepgrid::study {
namespace {

using Error = std::function<double(const AccuracyPoint&)>;
using Cost = std::function<Spread(const AccuracyPoint&)>;

// Every configuration as a labelled point, a series for each guarantee, and the Pareto front of all.
std::vector<Series> scatter(const std::vector<AccuracyPoint>& points, const Error& error, const Cost& cost) {
  std::vector<Series> series;
  for (const Guarantee kind : {Guarantee::kExact, Guarantee::kSuperset, Guarantee::kMayMiss}) {
    Series one{guarantee_name(kind), SeriesStyle::kScatter, {}};
    for (const AccuracyPoint& point : points) {
      if (point.guarantee != kind) continue;
      const Spread time = cost(point);
      one.points.push_back({error(point), time.median, time.low, time.high, point.name});
    }
    series.push_back(std::move(one));  // an empty one as well, so that all panels have the same colours
  }
  std::vector<Place> places;
  places.reserve(points.size());
  for (const AccuracyPoint& point : points) places.push_back({error(point), cost(point).median});
  Series front{"Pareto front", SeriesStyle::kFront, {}};
  for (const std::size_t i : pareto_front(places)) {
    front.points.push_back({places[i].error, places[i].cost, {}, {}, points[i].name});
  }
  series.push_back(std::move(front));
  return series;
}

std::string truth_title(accuracy::TruthKind kind) {
  switch (kind) {
    case accuracy::TruthKind::kInstants:
      return "T0, boxes overlap at the step";
    case accuracy::TruthKind::kMotion:
      return "T1, boxes meet on the way";
    case accuracy::TruthKind::kShapes:
      break;
  }
  return "T2, shapes touch";
}

LineChart panel(const std::string& id, const std::string& title, const std::string& caption, Axis x, Axis y,
                std::vector<Series> series) {
  return {id, title, caption, std::move(x), std::move(y), std::move(series)};
}

void add_panels(const SceneResult& result, std::size_t truth, const std::string& id, double narrow_ns,
                std::vector<LineChart>& charts) {
  const std::vector<AccuracyPoint> points = points_of(result, truth);
  const accuracy::TruthKind kind = result.truths[truth];
  const std::string begin = fmt::format("{}-t{}", id, static_cast<int>(kind));
  const Error missed = &AccuracyPoint::missed_percent;
  const Error extra = &AccuracyPoint::extra_percent;
  const Cost step = [](const AccuracyPoint& point) { return point.step_ms; };
  const Cost total = [narrow_ns](const AccuracyPoint& point) { return point.total_ms(narrow_ns); };
  const Axis missed_axis{"true pairs that are missed", "%"};
  const Axis step_axis{"time per step", "ms", true};
  charts.push_back(panel(begin + "-missed", truth_title(kind) + ": missed pairs",
                         "A point at 0 missed nothing at all. Bars: least and most of the rounds.", missed_axis,
                         step_axis, scatter(points, missed, step)));
  charts.push_back(panel(begin + "-extra", truth_title(kind) + ": extra pairs",
                         "A point at 0 reported no pair that is none. Bars: least and most of the rounds.",
                         {"reported pairs that are none", "%"}, step_axis, scatter(points, extra, step)));
  std::vector<Series> totals = scatter(points, missed, total);
  const std::size_t best = cheapest_complete(points, narrow_ns);
  if (best < points.size()) {
    totals.push_back({"cheapest that missed nothing",
                      SeriesStyle::kScatter,
                      {{0, total(points[best]).median, {}, {}, points[best].name}}});
  }
  charts.push_back(panel(begin + "-total", truth_title(kind) + ": total with a narrow phase",
                         fmt::format("A step, and {:.4g} ns for each pair that it reports.", narrow_ns), missed_axis,
                         {"total per step", "ms", true}, std::move(totals)));
}

// Lines for those configurations that are the cheapest somewhere among those that missed nothing, and for the exact
// one.
LineChart price_chart(const SceneResult& result, const std::string& id) {
  constexpr int kSteps = 16;
  constexpr double kDearest = 1e5;  // ns; from 10 on
  const std::vector<AccuracyPoint> points = points_of(result, 0);
  std::vector<double> prices;
  for (int i = 0; i <= kSteps; ++i) prices.push_back(kDearest * std::pow(10.0, 4.0 * i / kSteps - 4));
  std::set<std::size_t> chosen;
  if (!points.empty()) chosen.insert(0);
  for (const double price : prices) {
    const std::size_t best = cheapest_complete(points, price);
    if (best < points.size()) chosen.insert(best);
  }
  LineChart chart =
      panel(id + "-price", "What a narrow phase makes of it",
            "The first configuration, and those that are the cheapest at some price among all that missed "
            "no pair of T0. The lowest line is the one to take.",
            {"price of a narrow phase, per pair", "ns", true}, {"total per step", "ms", true}, {});
  for (const std::size_t i : chosen) {
    Series& line = chart.series.emplace_back();
    line.name = points[i].name;
    for (const double price : prices) {
      const Spread total = points[i].total_ms(price);
      line.points.push_back({price, total.median, total.low, total.high, {}});
    }
  }
  return chart;
}

}  // namespace

std::vector<LineChart> scene_charts(const SceneResult& result, const std::string& id, double narrow_ns) {
  std::vector<LineChart> charts;
  for (std::size_t truth = 0; truth < result.truths.size(); ++truth) {
    add_panels(result, truth, id, narrow_ns, charts);
  }
  charts.push_back(price_chart(result, id));
  return charts;
}

}  // namespace sweepgrid::study
