// Section 4: what the authors measured.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "study/figures/figure_plans.hpp"
#include "study/figures/paper_claims.hpp"

namespace sweepgrid::study {
namespace {

const std::string kBatchCell = system_name::one_cell(CellKind::kBatch);
const std::string kSegmentedCell = system_name::one_cell(CellKind::kSegmented);
const std::string kBatchGrid = system_name::grid(CellKind::kBatch);
const std::string kSegmentedGrid = system_name::grid(CellKind::kSegmented);

std::optional<double> global_sorts_per_step(const Results& results, const std::string& system) {
  const Entry* entry = results.find(figure::k8, system, 150);
  return entry == nullptr ? std::nullopt : std::optional(entry->per_step(entry->work.cells.global_sorts));
}

void add_correctness(std::vector<Claim>& claims, const Results& results) {
  std::optional<double> wrong;
  for (const Results::Played& played : results.all()) {
    for (const Entry& entry : played.contest.entries) wrong = wrong.value_or(0) + (entry.complaint.empty() ? 0 : 1);
  }
  claims.push_back(with({.where = "3.1, 4",
                         .says = "Output is correct and without duplicates, compared with a known algorithm",
                         .what = "runs whose pairs at the end were not exactly those of the independent computation",
                         .band = {0, 0},
                         .why_more = "See the table under Exactness.",
                         .digits = 0},
                        wrong));
  claims.push_back(with({.where = "4",
                         .says = "A batch cell sorts globally as soon as an insert or erase is pending",
                         .what = "global sorts per step, one insert and one erase, 5 % of 3000 moving, exact count",
                         .band = {1, 1},
                         .why_less = "Few events are applied without a pass."},
                        global_sorts_per_step(results, kBatchCell)));
  claims.push_back(with({.where = "4",
                         .says = "... a segmented cell only above a threshold of all operations",
                         .what = "the same for a segmented cell",
                         .band = {0, 0},
                         .why_more = "The threshold is below 5 % here."},
                        global_sorts_per_step(results, kSegmentedCell)));
}

void add_implementation(std::vector<Claim>& claims, const Results& results) {
  claims.push_back({.where = "4",
                    .says = "The octree spends over 80 % of its time traversing arrays",
                    .what = "",
                    .beyond_us = "A profile of the authors' program, not of a method."});
  const std::pair<const char*, const char*> sorts[] = {{system_name::kBatchLocal, system_name::kBatchGlobal},
                                                       {system_name::kSegmentedLocal, system_name::kSegmentedGlobal}};
  for (const auto& [local, global] : sorts) {
    claims.push_back(
        with({.where = "4",
              .says = "A global sort is over 30 % faster when most objects move",
              .what = fmt::format("{} / {}, 3000 objects", local, global),
              .band = {.low = 1.3},
              .why_less = "A local sort starts at the endpoint that it moves, here found without a search, "
                          "so it has little to lose."},
             results.times_faster(figure::kSorts, 3000, local, global)));
  }
}

// What the batch cell's time consists of when few objects move: the pass over all lists that one event enforces.
const char* const kWhyLess =
    "Here a batch cell's pass over its lists is cheap (endpoints are single integers, and up to 12 events are tested "
    "directly, without sweep sets), so an event has less to save.";
const char* const kWhyMore = "Here the pass over all lists, which one event enforces in a batch cell, weighs more.";

void add_figure_8(std::vector<Claim>& claims, const Results& results) {
  struct Part {
    double moving;
    const char* says;
    Band band;
  };
  const Part parts[] = {
      {600, "One insert and one erase, 20 % moving: segmented lists are 60 % faster than batch", {1.3, 1.95}},
      {150, "... 5 % moving: three times as fast", {2.4, 3.75}},
      {3000, "... when most objects move both are about as fast", {0.8, 1.25}}};
  for (const Part& part : parts) {
    claims.push_back(with({.where = "4.1, Figure 8",
                           .says = part.says,
                           .what = fmt::format("batch / segmented, {} of 3000 moving", part.moving),
                           .band = part.band,
                           .why_less = kWhyLess,
                           .why_more = kWhyMore},
                          results.times_faster(figure::k8, part.moving, kBatchCell, kSegmentedCell)));
  }
}

// Time per further event, between x = `from` and the last point.
std::optional<double> slope(const Results& results, const std::string& figure, const std::string& system, double from,
                            double to) {
  const Entry* first = results.find(figure, system, from);
  const Entry* last = results.find(figure, system, to);
  if (first == nullptr || last == nullptr) return std::nullopt;
  return (median_seconds(*last) - median_seconds(*first)) / (to - from);
}

std::optional<double> quotient(const std::optional<double>& above, const std::optional<double>& below) {
  return above && below ? std::optional(*above / *below) : std::nullopt;
}

// At worst, how many times as long as the better of batch and segmented the presorted segmented method takes.
std::optional<double> presorted_at_worst(const Results& results, const std::string& figure, const std::string& batch,
                                         const std::string& segmented, const std::string& presorted) {
  std::optional<double> worst;
  for (const Entry* entry : results.series(figure, presorted)) {
    const Entry* first = results.find(figure, batch, entry->x);
    const Entry* second = results.find(figure, segmented, entry->x);
    if (first == nullptr || second == nullptr) continue;
    const double best = std::min(median_seconds(*first), median_seconds(*second));
    worst = std::max(worst.value_or(0), median_seconds(*entry) / best);
  }
  return worst;
}

void add_figure_9(std::vector<Claim>& claims, const Results& results) {
  claims.push_back(with({.where = "4.1, Figure 9",
                         .says = "One insert and one erase, 150 of 3000 moving: almost three times as fast as batch",
                         .what = "batch / segmented, 2 events",
                         .band = {2.2, 3.3},
                         .why_less = kWhyLess,
                         .why_more = kWhyMore},
                        results.times_faster(figure::k9, 2, kBatchCell, kSegmentedCell)));
  claims.push_back(with({.where = "4.1, Figure 9",
                         .says = "Ten inserts and ten erases: still 90 % faster",
                         .what = "batch / segmented, 20 events",
                         .band = {1.5, 2.3},
                         .why_less = kWhyLess,
                         .why_more = kWhyMore},
                        results.times_faster(figure::k9, 20, kBatchCell, kSegmentedCell)));
  claims.push_back(
      with({.where = "4.1, Figure 9",
            .says = "The cut-off is slightly less than 80 events",
            .what = "events from which on segmented takes longer than batch",
            .band = {55, 100},
            .why_less = "An event costs a segmented cell more here, beside what a batch cell's pass costs.",
            .why_more = "An event costs a segmented cell less here (its tests and its search), beside what "
                        "a batch cell's pass and sweep sets cost.",
            .digits = 0},
           results.crossing(figure::k9, kSegmentedCell, kBatchCell)));
  claims.push_back(with(
      {.where = "4.1, Figure 9",
       .says = "A further event costs batch less than it costs segmented lists",
       .what = "segmented / batch, time per further event from 40 to 200 events",
       .band = {.low = 1},
       .why_less = "An event costs batch more: all that its sweep sets hold is tested."},
      quotient(slope(results, figure::k9, kSegmentedCell, 40, 200), slope(results, figure::k9, kBatchCell, 40, 200))));
  claims.push_back(
      with({.where = "4.1",
            .says = "Presorting events and integrating them segment by segment should pass smoothly from "
                    "the best of segmented lists to the best of batch",
            .what = "presorted / better of the two, at worst over all points of Figure 9",
            .band = {.high = 1.15},
            .why_more = "Sorting the events and finding their segments costs more than it saves when they "
                        "are few, or the pass over segments more than that over one array when they are "
                        "many."},
           presorted_at_worst(results, figure::k9, kBatchCell, kSegmentedCell, system_name::kPresortedCell)));
}

void add_figure_10(std::vector<Claim>& claims, const Results& results) {
  claims.push_back(
      with({.where = "4.2, Figure 10",
            .says = "Grid of 100 000 objects, 10 000 moving: the crossover is at 4000 events",
            .what = "events from which on segmented takes longer than batch",
            .band = {2500, 6000},
            .why_less = "Each moving object that changes cells is an insert and an erase in every cell that "
                        "it enters or leaves, so most cells pass over their lists before any event.",
            .why_more = "An event costs a segmented cell less here, beside what a batch cell's pass costs.",
            .digits = 0},
           results.crossing(figure::k10, kSegmentedGrid, kBatchGrid)));
  claims.push_back(with(
      {.where = "4.2, Figure 10",
       .says = "Batch slows down significantly with the first events, and less with further ones",
       .what = "time per event, first thousand / from 4000 to 8000",
       .band = {.low = 1.2},
       .why_less = "Objects that change cells make most cells pass over their lists already without "
                   "events, so that the first ones have nothing to add."},
      quotient(slope(results, figure::k10, kBatchGrid, 0, 1000), slope(results, figure::k10, kBatchGrid, 4000, 8000))));
  claims.push_back(with({.where = "4.2, Figure 10",
                         .says = "Segmented lists are much more efficient at few events",
                         .what = "batch / segmented, no events but the moving objects' own",
                         .band = {.low = 1.3},
                         .why_less = "In cells of 300 objects a pass over all lists is short, and batch cells sort "
                                     "locally where no object comes or goes."},
                        results.times_faster(figure::k10, 0, kBatchGrid, kSegmentedGrid)));
  claims.push_back(
      with({.where = "4.2",
            .says = "Presorting could improve the slope in the grid as well",
            .what = "presorted / better of the two, at worst over all points of Figure 10",
            .band = {.high = 1.15},
            .why_more = "A cell gets too few events at a time for sorting them to pay."},
           presorted_at_worst(results, figure::k10, kBatchGrid, kSegmentedGrid, system_name::kPresortedGrid)));
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
  const std::string why_faster =
      "The baseline here keeps for each object where it is and what it overlaps, so objects at rest cost it nothing "
      "either; the authors' octree could not use coherence.";
  const auto octree_slower = [&](const char* figure, double x, const char* says, const char* what) {
    claims.push_back(with(
        {.where = "4.2, Figures 10 and 11", .says = says, .what = what, .band = {.low = 1}, .why_less = why_faster},
        results.times_faster(figure, x, system_name::kOctree, kSegmentedGrid)));
  };
  octree_slower(figure::k11, 200000, "The octree is generally slower than a grid of sweep and prune",
                "octree / segmented in a grid, Figure 11, 200 000 objects");
  octree_slower(figure::kCoherence, 0.01, "... above all when most objects rest",
                "octree / segmented in a grid, 1 % moving");
  octree_slower(figure::kSpeed, 0.01, "... or when they are slow",
                "octree / segmented in a grid, all moving, 0.01 widths per step");
  claims.push_back(with({.where = "4.2",
                         .says = "... and faster only where coherence is low",
                         .what = "segmented in a grid / octree, all moving, a width per step",
                         .band = {.low = 1},
                         .why_less = "Even then the grid is faster."},
                        results.times_faster(figure::kSpeed, 1, kSegmentedGrid, system_name::kOctree)));
}

void add_figure_11(std::vector<Claim>& claims, const Results& results) {
  const char* const why_less =
      "In cells of 300 objects a batch pass is short; what both share (finding cells, witness counts, events) is most "
      "of "
      "a step, and the same for both.";
  claims.push_back(with({.where = "4.2, Figure 11",
                         .says = "10 % moving, 0.5 % inserted and erased: segmented is slightly faster at small scales",
                         .what = "batch / segmented in a grid, 10 000 objects",
                         .band = {1, 1.4},
                         .why_less = why_less,
                         .why_more = kWhyMore},
                        results.times_faster(figure::k11, 10000, kBatchGrid, kSegmentedGrid)));
  claims.push_back(with({.where = "4.2, Figure 11",
                         .says = "... almost twice as fast at 200 000 objects",
                         .what = "batch / segmented in a grid, 200 000 objects",
                         .band = {1.6, 2.2},
                         .why_less = why_less,
                         .why_more = kWhyMore},
                        results.times_faster(figure::k11, 200000, kBatchGrid, kSegmentedGrid)));
  const auto uniform = results.times_faster(figure::kClumped, 0.1, kBatchGrid + system_name::kUniformSuffix,
                                            kSegmentedGrid + system_name::kUniformSuffix);
  const auto clumped = results.times_faster(figure::kClumped, 0.1, kBatchGrid, kSegmentedGrid);
  const auto resting = results.times_faster(figure::kClumped, 0.01, kBatchGrid + system_name::kUniformSuffix,
                                            kSegmentedGrid + system_name::kUniformSuffix);
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
                         .says = "... and when fewer objects move",
                         .what = "batch / segmented with 1 % moving, over the same with 10 %",
                         .band = {.low = 1},
                         .why_less = "With as many inserts and erases, fewer movers leave batch less to do as well."},
                        quotient(median(resting), median(uniform))));
}

void add_conclusions(std::vector<Claim>& claims, const Results& results) {
  std::optional<double> most;
  const auto consider = [&](const char* figure, const std::string& batch, const std::string& segmented) {
    for (const Entry* entry : results.series(figure, segmented)) {
      const auto ratio = results.times_faster(figure, entry->x, batch, segmented);
      if (ratio) most = std::max(most.value_or(0), ratio->median);
    }
  };
  consider(figure::k8, kBatchCell, kSegmentedCell);
  consider(figure::k9, kBatchCell, kSegmentedCell);
  consider(figure::k10, kBatchGrid, kSegmentedGrid);
  consider(figure::k11, kBatchGrid, kSegmentedGrid);
  claims.push_back(with({.where = "4.3",
                         .says = "Inserts and erases several times faster than by batch methods",
                         .what = "batch / segmented, the most in Figures 8 to 11",
                         .band = {.low = 2},
                         .why_less = kWhyLess},
                        most));
  claims.push_back({.where = "4.3",
                    .says = "The same in Scalable City, a large virtual world",
                    .what = "",
                    .beyond_us = "The program and its scenes are not to be had."});
}

}  // namespace

std::vector<Claim> claims_on_results(const Results& results) {
  std::vector<Claim> claims;
  for (const auto add : {add_correctness, add_implementation, add_figure_8, add_figure_9, add_figure_10, add_octree,
                         add_figure_11, add_conclusions}) {
    add(claims, results);
  }
  return claims;
}

}  // namespace sweepgrid::study
