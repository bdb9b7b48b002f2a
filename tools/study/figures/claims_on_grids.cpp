// Section 4.2: what the authors measured in grids, and beside the octree.
#include <algorithm>

#include <fmt/format.h>

#include "study/figures/batch_and_segmented.hpp"
#include "study/figures/claimed_systems.hpp"
#include "study/figures/figure_plans.hpp"
#include "study/figures/paper_claims.hpp"

namespace sweepgrid::study {
namespace {

void add_presorted_grids(std::vector<Claim>& claims, const Results& results) {
  for (const char* const system : {system_name::kPresortedGrid, system_name::kAutoGrid}) {
    const auto worst = presorted_at_worst(results, figure::k10, claimed::kBatchGrid, claimed::kSegmentedGrid, system);
    claims.push_back(
        with({.where = "4.2",
              .says = "Presorting could improve the slope in the grid as well",
              .what = fmt::format("{} / better of the two, at worst over Figure 10{}", system, at_text(worst)),
              .band = {.high = 1.15},
              .why_more = presorted_reason(worst)},
             ratio_of(worst)));
  }
}

void add_figure_10(std::vector<Claim>& claims, const Results& results) {
  const std::string costs =
      cost_text(results, figure::k10, claimed::kBatchGrid, claimed::kSegmentedGrid, 0, 4000, "event") + " " +
      sorts_text(results, figure::k10, 0);
  claims.push_back(with({.where = "4.2, Figure 10",
                         .says = "Grid of 100 000 objects, 10 000 moving: the crossover is at 4000 events",
                         .what = "events from which on segmented takes longer than batch",
                         .band = {2500, 6000},
                         .why_less = costs,
                         .why_more = costs,
                         .digits = 0},
                        results.crossing(figure::k10, claimed::kSegmentedGrid, claimed::kBatchGrid)));
  claims.push_back(with({.where = "4.2, Figure 10",
                         .says = "Batch slows down significantly with the first events, and less with further ones",
                         .what = "time per event, first thousand / from 4000 to 8000",
                         .band = {.low = 1.2},
                         .why_less = "The first events have little to add. " + sorts_text(results, figure::k10, 0)},
                        quotient(slope(results, figure::k10, claimed::kBatchGrid, 0, 1000),
                                 slope(results, figure::k10, claimed::kBatchGrid, 4000, 8000))));
  claims.push_back(with({.where = "4.2, Figure 10",
                         .says = "Segmented lists are much more efficient at few events",
                         .what = "batch / segmented, no events but the moving objects' own",
                         .band = {.low = 1.3},
                         .why_less = costs + " A pass over a cell of 300 objects is short."},
                        results.times_faster(figure::k10, 0, claimed::kBatchGrid, claimed::kSegmentedGrid)));
  add_presorted_grids(claims, results);
}

std::optional<double> ratio_of_times(const Results& results, const char* figure, const char* system, double x,
                                     double base) {
  const Entry* here = results.find(figure, system, x);
  const Entry* there = results.find(figure, system, base);
  if (here == nullptr || there == nullptr) return std::nullopt;
  return median_seconds(*here) / median_seconds(*there);
}

void add_octree(std::vector<Claim>& claims, const Results& results) {
  claims.push_back(with({.where = "4.2",
                         .says = "The octree is insensitive to inserts and erases",
                         .what = "octree's time with 4000 events / with none, 10 000 moving",
                         .band = {0.8, 1.25},
                         .why_more = "The baseline here updates its tree instead of building it anew, so that an event "
                                     "costs what a moved object costs, and more: its pairs end or begin."},
                        ratio_of_times(results, figure::k10, system_name::kOctree, 4000, 0)));
  const auto why_faster = [&](const char* figure, double x) {
    const auto ratio = results.times_faster(figure, x, system_name::kOctree, system_name::kEngine);
    const std::string engine =
        ratio ? fmt::format(" The engine as it chooses is {:.2f} times as fast as the octree.", ratio->median) : "";
    return "The baseline here remembers where each object is and what it overlaps, so that objects at rest cost it "
           "nothing either, and a moving one is tested in a few leaves." +
           engine;
  };
  const auto octree_slower = [&](const char* figure, double x, const char* says, const char* what) {
    claims.push_back(with({.where = "4.2, Figures 10 and 11",
                           .says = says,
                           .what = what,
                           .band = {.low = 1},
                           .why_less = why_faster(figure, x)},
                          results.times_faster(figure, x, system_name::kOctree, claimed::kSegmentedGrid)));
  };
  octree_slower(figure::k11, 200000, "The octree is generally slower than a grid of sweep and prune",
                "octree / segmented in a grid, Figure 11, 200 000 objects");
  octree_slower(figure::kCoherence, 0.01, "The octree is slower above all when most objects rest",
                "octree / segmented in a grid, 1 % moving");
  octree_slower(figure::kSpeed, 0.01, "The octree is slower when objects are slow",
                "octree / segmented in a grid, all moving, 0.01 widths per step");
  claims.push_back(with({.where = "4.2",
                         .says = "The octree is faster where coherence is low",
                         .what = "segmented in a grid / octree, all moving, a width per step",
                         .band = {.low = 1},
                         .why_less = "Even then the grid is faster."},
                        results.times_faster(figure::kSpeed, 1, claimed::kSegmentedGrid, system_name::kOctree)));
}

void add_figure_11(std::vector<Claim>& claims, const Results& results) {
  const auto overtaken = results.crossing(figure::k8, system_name::one_cell(CellKind::kSegmented),
                                          system_name::one_cell(CellKind::kBatch));
  const std::string overtaken_text =
      overtaken
          ? fmt::format(" In one cell batch overtakes segmented lists where {:.0f} % move (Figure 8); here 10 % do.",
                        *overtaken / 30)
          : "";
  struct Part {
    double objects;
    const char* says;
    Band band;
  };
  const Part parts[] = {
      {10000, "10 % moving, 0.5 % inserted and erased: segmented is slightly faster at small scales", {1, 1.4}},
      {200000, "The same: almost twice as fast at 200 000 objects", {1.6, 2.2}}};
  for (const Part& part : parts) {
    const std::string why = sorts_text(results, figure::k11, part.objects) + overtaken_text;
    claims.push_back(
        with({.where = "4.2, Figure 11",
              .says = part.says,
              .what = fmt::format("batch / segmented in a grid, {} objects", part.objects),
              .band = part.band,
              .why_less = why,
              .why_more = why},
             results.times_faster(figure::k11, part.objects, claimed::kBatchGrid, claimed::kSegmentedGrid)));
  }
}

void add_clumped(std::vector<Claim>& claims, const Results& results) {
  const auto uniform = results.times_faster(figure::kClumped, 0.1, claimed::kBatchGrid + system_name::kUniformSuffix,
                                            claimed::kSegmentedGrid + system_name::kUniformSuffix);
  const auto clumped = results.times_faster(figure::kClumped, 0.1, claimed::kBatchGrid, claimed::kSegmentedGrid);
  const auto resting = results.times_faster(figure::kClumped, 0.01, claimed::kBatchGrid + system_name::kUniformSuffix,
                                            claimed::kSegmentedGrid + system_name::kUniformSuffix);
  const auto median = [](const std::optional<Spread>& spread) {
    return spread ? std::optional(spread->median) : std::nullopt;
  };
  claims.push_back(with({.where = "4.2",
                         .says = "The advantage widens when the distribution is not uniform",
                         .what = "batch / segmented, clumped, over the same, uniform",
                         .band = {.low = 1},
                         .why_less = "Crowded cells have more moving objects at a time as well, which favours batch."},
                        quotient(median(clumped), median(uniform))));
  claims.push_back(with({.where = "4.2",
                         .says = "The advantage widens when fewer objects move",
                         .what = "batch / segmented with 1 % moving, over the same with 10 %",
                         .band = {.low = 1},
                         .why_less = "With as many inserts and erases, fewer movers leave batch less to do as well."},
                        quotient(median(resting), median(uniform))));
}

}  // namespace

std::vector<Claim> claims_on_grids(const Results& results) {
  std::vector<Claim> claims;
  for (const auto add : {add_figure_10, add_octree, add_figure_11, add_clumped}) add(claims, results);
  return claims;
}

}  // namespace sweepgrid::study
