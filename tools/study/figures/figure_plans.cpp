#include "study/figures/figure_plans.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "cli/cell_names.hpp"

namespace sweepgrid::study {
namespace {

using system_name::grid;
using system_name::one_cell;

// Section 4: uniform cubes at 5 % volumetric density that move by a tenth of their width and bounce.
std::string paper_scene(double n, double moving, double churn) {
  return fmt::format("uniform:n={},moving={},churn={},density=0.05,speed=0.1", n, moving, churn);
}

// As the paper has them: no segmented cell presorts its inserts and erases.
CellOptions cell_options(CellKind kind) { return {.kind = kind, .integration = Integration::kOneByOne}; }
constexpr CellOptions kPresorted = {.kind = CellKind::kSegmented, .integration = Integration::kPresorted};

SystemSpec cell_spec(CellKind kind) { return {one_cell(kind), Layout::kOneCell, cell_options(kind)}; }
SystemSpec grid_spec(CellKind kind) { return {grid(kind), Layout::kGrid, cell_options(kind)}; }
constexpr CellOptions kPresortedIfItPays = {.kind = CellKind::kSegmented, .integration = Integration::kAuto};

SystemSpec presorted_cell() { return {system_name::kPresortedCell, Layout::kOneCell, kPresorted}; }
SystemSpec presorted_grid() { return {system_name::kPresortedGrid, Layout::kGrid, kPresorted}; }
SystemSpec auto_cell() { return {system_name::kAutoCell, Layout::kOneCell, kPresortedIfItPays}; }
SystemSpec auto_grid() { return {system_name::kAutoGrid, Layout::kGrid, kPresortedIfItPays}; }
SystemSpec octree_spec() { return {system_name::kOctree, Layout::kOctree}; }
SystemSpec engine_spec() { return {system_name::kEngine, Layout::kEngine}; }

std::vector<SystemSpec> cell_specs(std::initializer_list<CellKind> kinds) {
  std::vector<SystemSpec> specs;
  for (const CellKind kind : kinds) specs.push_back(cell_spec(kind));
  return specs;
}

std::vector<SystemSpec> grid_specs(std::initializer_list<CellKind> kinds) {
  std::vector<SystemSpec> specs;
  for (const CellKind kind : kinds) specs.push_back(grid_spec(kind));
  return specs;
}

std::vector<SystemSpec> joined(std::vector<SystemSpec> some, std::vector<SystemSpec> more) {
  std::move(more.begin(), more.end(), std::back_inserter(some));
  return some;
}

std::vector<SystemSpec> at(double x, std::vector<SystemSpec> specs) {
  for (SystemSpec& spec : specs) spec.x = x;
  return specs;
}

constexpr auto kClassic = CellKind::kClassic;
constexpr auto kBatch = CellKind::kBatch;
constexpr auto kSegmented = CellKind::kSegmented;
constexpr auto kRows = CellKind::kRows;
constexpr auto kPlane = CellKind::kPlane;

// All that a figure of a whole environment shows.
std::vector<SystemSpec> grid_systems() {
  return joined(grid_specs({kClassic, kBatch, kSegmented, kRows}), {presorted_grid(), engine_spec(), octree_spec()});
}

/// What a point's scene asks of a system.
struct Load {
  double objects;  // in all
  double touched;  // in a step: moved, inserted, erased, or passed over in a cell's lists
};

// Roughly; only for the time that is left. A cell's swaps grow with n^(2/3) for each update, and filling it takes the
// classic kind 3 n^2 swaps.
double expected_seconds(const SystemSpec& spec, const Load& load, double steps) {
  if (spec.layout != Layout::kOneCell) return 1e-6 * load.objects + 4e-7 * load.touched * steps;
  const double start = spec.cell.kind == kClassic ? 2e-9 * load.objects * load.objects : 1e-6 * load.objects;
  return start + 1.5e-7 * load.touched * steps * std::pow(load.objects / 1000, 2.0 / 3);
}

/// Collects points; the amount of work is chosen here.
class Plans {
 public:
  explicit Plans(bool quick) : quick_(quick) {}

  // The values of a figure's axis, in full and when it must be quick.
  [[nodiscard]] std::vector<double> either(std::vector<double> full, std::vector<double> quick) const {
    return quick_ ? std::move(quick) : std::move(full);
  }
  [[nodiscard]] bool quick() const { return quick_; }

  // A point where all systems have the same x.
  void add(const char* figure, double x, const std::string& scene, std::vector<SystemSpec> systems, const Load& load) {
    add_contest(figure, fmt::format("{}", x), scene, at(x, std::move(systems)), load);
  }

  void add_contest(const char* figure, const std::string& name, const std::string& scene,
                   std::vector<SystemSpec> systems, const Load& load) {
    const double budget = quick_ ? 1e5 : 1e6;  // objects touched in all steps together
    const int rounds = quick_ ? 3 : 7;
    const double steps = budget / rounds / std::max(load.touched, 1.0);
    ContestPlan plan{scene, std::move(systems), rounds, std::clamp(static_cast<int>(steps), 2, quick_ ? 20 : 60)};
    double cost = 0.01 + 5e-9 * std::pow(load.objects, 5.0 / 3);  // the oracle's
    for (const SystemSpec& spec : plan.systems) {
      cost += expected_seconds(spec, load, (rounds + 1) * plan.steps_per_round);
    }
    points_.push_back({figure, name, std::move(plan), cost});
  }

  [[nodiscard]] std::vector<FigurePoint> take() { return std::move(points_); }

 private:
  bool quick_;
  std::vector<FigurePoint> points_;
};

// What one cell is given. Filling it takes the classic kind O(n^2) swaps.
std::vector<SystemSpec> cells_for(double n, double classic_limit, double limit) {
  std::vector<SystemSpec> systems;
  if (n <= classic_limit) systems.push_back(cell_spec(kClassic));
  if (n <= limit) systems = joined(systems, cell_specs({kBatch, kSegmented}));
  return systems;
}

void plan_2(Plans& plans) {
  const double classic_limit = plans.quick() ? 8000 : 64000;
  const double limit = plans.quick() ? 32000 : 128000;
  for (const double n :
       plans.either({1000, 2000, 4000, 8000, 16000, 32000, 64000, 128000}, {1000, 2000, 4000, 8000, 16000, 32000})) {
    const double cost_factor = n <= limit ? std::max(1.0, std::cbrt(n / 1000)) : 1;
    plans.add(figure::k2, n, paper_scene(n, 1, 0), joined(cells_for(n, classic_limit, limit), grid_systems()),
              {n, n * cost_factor});
  }
}

void plan_8(Plans& plans) {
  const auto moving =
      plans.either({0, 30, 75, 150, 300, 450, 600, 900, 1200, 1500, 2000, 2500, 3000}, {30, 150, 300, 600, 1500, 3000});
  for (const double count : moving) {
    plans.add(figure::k8, count, paper_scene(3000, count / 3000, 1.0 / 3000),
              joined(cell_specs({kClassic, kBatch, kSegmented, kRows}), {presorted_cell()}), {3000, 3000});
  }
}

void plan_9(Plans& plans) {
  const auto events = plans.either({2, 4, 10, 20, 30, 40, 50, 60, 70, 80, 100, 120, 160, 200, 300, 400, 600},
                                   {2, 20, 40, 80, 120, 200, 400});
  for (const double count : events) {
    plans.add(figure::k9, count, paper_scene(3000, 0.05, count / 2 / 3000),
              joined(cell_specs({kClassic, kBatch, kSegmented, kRows}), {presorted_cell(), auto_cell()}), {3000, 3000});
  }
}

void plan_10(Plans& plans) {
  const auto events =
      plans.either({0, 200, 500, 1000, 1500, 2000, 3000, 4000, 5000, 6000, 8000, 12000}, {0, 1000, 4000, 8000});
  for (const double count : events) {
    plans.add(figure::k10, count, paper_scene(1e5, 0.1, count / 2 / 1e5), joined(grid_systems(), {auto_grid()}),
              {1e5, 1e4 + count});
  }
}

void plan_11(Plans& plans) {
  const double classic_limit = plans.quick() ? 10000 : 50000;
  const double limit = plans.quick() ? 10000 : 200000;
  for (const double n : plans.either({10000, 20000, 50000, 100000, 150000, 200000}, {10000, 50000, 200000})) {
    plans.add(figure::k11, n, paper_scene(n, 0.1, 0.005), joined(cells_for(n, classic_limit, limit), grid_systems()),
              {n, 0.11 * n});
  }
}

// All grids in one contest, so that what slows the machine for a while does not choose the best.
void plan_population(Plans& plans) {
  const double n = plans.quick() ? 6250 : 50000;
  const double edge = std::cbrt(n / 0.05);
  const auto cells_along = plans.either({3, 4, 5, 6, 7, 8, 10, 12, 16, 20, 25}, {1, 2, 3, 4, 6, 8, 10});
  std::vector<SystemSpec> systems;
  for (const CellKind kind : {kClassic, kBatch, kSegmented, kRows}) {
    for (const double count : cells_along) {
      SystemSpec& spec = systems.emplace_back(grid_spec(kind));
      spec.population = std::pow(edge / count + 1, 3) * 0.05;
      spec.x = std::round(std::min(spec.population, n));
    }
  }
  plans.add_contest(figure::kPopulation, "all", paper_scene(n, 0.1, 0.005), systems, {n, 0.11 * n});
}

void plan_segments(Plans& plans) {
  const auto capacities = plans.either({8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256}, {8, 16, 32, 64, 128, 256});
  const auto specs = [&](const char* name) {
    std::vector<SystemSpec> systems;
    for (const double capacity : capacities) {
      SystemSpec& spec = systems.emplace_back(cell_spec(kSegmented));
      spec.name = name;
      spec.cell.segment_capacity = static_cast<int>(capacity);
      spec.x = capacity;
    }
    return systems;
  };
  plans.add_contest(figure::kSegments, "events", paper_scene(3000, 0, 10.0 / 3000), specs(system_name::kSegmentsEvents),
                    {3000, 1000});
  plans.add_contest(figure::kSegments, "sort", paper_scene(3000, 0.2, 0), specs(system_name::kSegmentsSort),
                    {3000, 1000});
}

// A drain of few updates is sorted locally, so that many updates are, too, when they come in several drains.
void plan_sorts(Plans& plans) {
  const auto spec = [](const char* name, CellKind kind, int pieces) {
    SystemSpec result = cell_spec(kind);
    result.name = name;
    result.pieces = pieces;
    return result;
  };
  for (const double n : plans.either({300, 1000, 3000}, {3000})) {
    plans.add(figure::kSorts, n, paper_scene(n, 1, 0),
              {spec(system_name::kBatchGlobal, kBatch, 1), spec(system_name::kBatchLocal, kBatch, 4),
               spec(system_name::kSegmentedGlobal, kSegmented, 1), spec(system_name::kSegmentedLocal, kSegmented, 5)},
              {n, n});
    plans.add_contest(
        figure::kSorts, fmt::format("{} few", n), paper_scene(n, 0.05, 0),
        at(n, {spec(system_name::kFewMovingGlobal, kClassic, 1), spec(system_name::kFewMovingLocal, kBatch, 1)}),
        {n, n});
  }
}

void plan_coherence(Plans& plans) {
  const double n = plans.quick() ? 10000 : 50000;
  const std::vector<SystemSpec> systems = joined(grid_specs({kBatch, kSegmented}), {engine_spec(), octree_spec()});
  for (const double share : plans.either({0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1}, {0.01, 0.1, 1})) {
    plans.add(figure::kCoherence, share, paper_scene(n, share, 0), systems, {n, share * n});
  }
  for (const double speed : plans.either({0.01, 0.03, 0.1, 0.3, 1, 3}, {0.01, 0.1, 1})) {
    plans.add(figure::kSpeed, speed, fmt::format("uniform:n={},moving=1,churn=0,density=0.05,speed={}", n, speed),
              systems, {n, n});
  }
}

void plan_clumped(Plans& plans) {
  const double n = plans.quick() ? 10000 : 50000;
  for (const double share : plans.either({0.01, 0.05, 0.1}, {0.01, 0.1})) {
    plans.add(
        figure::kClumped, share,
        fmt::format("clusters:n={},moving={},churn=0.005,density=0.05,speed=0.1,clusters=16,spread=0.1", n, share),
        grid_specs({kBatch, kSegmented}), {n, share * n});
    // The same without clumps, for the ratio.
    std::vector<SystemSpec> uniform = grid_specs({kBatch, kSegmented});
    for (SystemSpec& spec : uniform) spec.name += system_name::kUniformSuffix;
    plans.add_contest(figure::kClumped, fmt::format("{} uniform", share), paper_scene(n, share, 0.005),
                      at(share, std::move(uniform)), {n, share * n});
  }
}

void plan_replaced(Plans& plans) {
  for (const double share : plans.either({0.01, 0.03, 0.1, 0.3, 0.6, 1}, {0.01, 1})) {
    plans.add(figure::kReplaced, share, paper_scene(3000, 0.1, share), cell_specs({kBatch, kPlane}), {3000, 3000});
  }
}

// Exact counts; their times are of no interest.
void plan_work(Plans& plans) {
  for (const double n : plans.either({1000, 2000, 4000, 8000, 16000, 32000}, {1000, 2000, 4000})) {
    plans.add(figure::kFlat, n, paper_scene(n, 1, 0) + ",dim=2", cell_specs({kClassic}), {n, 3 * n});
  }
  for (const double n :
       plans.either({1000, 2000, 4000, 8000, 16000, 32000, 64000}, {1000, 2000, 4000, 8000, 16000, 32000})) {
    plans.add(figure::kInsertWork, n, paper_scene(n, 0, 10 / n),
              joined(cells_for(n, plans.quick() ? 8000 : 32000, n), grid_specs({kClassic, kSegmented})), {n, n});
  }
  plans.add(figure::kQuiet, 10000, paper_scene(10000, 0, 0), grid_specs({kClassic, kBatch, kSegmented}),
            {10000, 10000});
}

}  // namespace

std::string system_name::one_cell(CellKind kind) { return cell_name(kind) + ", one cell"; }

std::string system_name::grid(CellKind kind) { return cell_name(kind) + ", grid"; }

std::vector<FigurePoint> figure_points(bool quick, const std::vector<std::string>& figures) {
  Plans plans(quick);
  for (const auto plan : {plan_2, plan_8, plan_9, plan_10, plan_11, plan_population, plan_segments, plan_sorts,
                          plan_coherence, plan_clumped, plan_replaced, plan_work}) {
    plan(plans);
  }
  std::vector<FigurePoint> points = plans.take();
  if (figures.empty()) return points;
  std::erase_if(points, [&](const FigurePoint& point) {
    return std::find(figures.begin(), figures.end(), point.figure) == figures.end();
  });
  return points;
}

}  // namespace sweepgrid::study
