// Section 4: what the authors measured in one cell, and what they conclude.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "study/figures/batch_and_segmented.hpp"
#include "study/figures/claimed_systems.hpp"
#include "study/figures/figure_plans.hpp"
#include "study/figures/paper_claims.hpp"

namespace sweepgrid::study {
namespace {

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
                        global_sorts_per_step(results, claimed::kBatchCell)));
  claims.push_back(with({.where = "4",
                         .says = "A segmented cell sorts globally only above a threshold of all operations",
                         .what = "the same for a segmented cell",
                         .band = {0, 0},
                         .why_more = "The threshold is below 5 % here."},
                        global_sorts_per_step(results, claimed::kSegmentedCell)));
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

const char* const kCheapPass =
    " The pass over all lists that an event enforces in a batch cell is cheap here: an endpoint is one 64-bit integer, "
    "which is all that a swap compares and moves.";
const char* const kDearPass = " The pass over all lists that an event enforces in a batch cell is dear here.";

// A ratio of batch to segmented in one cell at a certain x.
struct RatioClaim {
  double x;
  const char* says;
  Band band;
};

void add_figure_8(std::vector<Claim>& claims, const Results& results) {
  const std::string costs =
      cost_text(results, figure::k8, claimed::kBatchCell, claimed::kSegmentedCell, 30, 600, "moving object");
  const RatioClaim parts[] = {
      {600, "One insert and one erase, 20 % moving: segmented lists are 60 % faster than batch", {1.3, 1.95}},
      {150, "One insert and one erase, 5 % moving: three times as fast", {2.4, 3.75}}};
  for (const RatioClaim& part : parts) {
    claims.push_back(with({.where = "4.1, Figure 8",
                           .says = part.says,
                           .what = fmt::format("batch / segmented, {} of 3000 moving", part.x),
                           .band = part.band,
                           .why_less = costs + kCheapPass,
                           .why_more = costs + kDearPass},
                          results.times_faster(figure::k8, part.x, claimed::kBatchCell, claimed::kSegmentedCell)));
  }
  claims.push_back(with({.where = "4.1, Figure 8",
                         .says = "One insert and one erase, most moving: both are about as fast",
                         .what = "batch / segmented, all of 3000 moving",
                         .band = {0.8, 1.25},
                         .why_less = "Both sort globally, and that takes longer over segments than over one array.",
                         .why_more = "Both sort globally, and that takes longer over one array than over segments."},
                        results.times_faster(figure::k8, 3000, claimed::kBatchCell, claimed::kSegmentedCell)));
}

void add_presorted(std::vector<Claim>& claims, const Results& results) {
  for (const char* const system : {system_name::kPresortedCell, system_name::kAutoCell}) {
    const auto worst = presorted_at_worst(results, figure::k9, claimed::kBatchCell, claimed::kSegmentedCell, system);
    claims.push_back(
        with({.where = "4.1",
              .says = "Presorting events and integrating them segment by segment should pass smoothly from the best of "
                      "segmented lists to the best of batch",
              .what = fmt::format("{} / better of the two, at worst over Figure 9{}", system, at_text(worst)),
              .band = {.high = 1.15},
              .why_more = presorted_reason(worst)},
             ratio_of(worst)));
  }
}

void add_figure_9(std::vector<Claim>& claims, const Results& results) {
  const std::string costs =
      cost_text(results, figure::k9, claimed::kBatchCell, claimed::kSegmentedCell, 2, 80, "event");
  const RatioClaim parts[] = {
      {2, "One insert and one erase, 150 of 3000 moving: almost three times as fast as batch", {2.2, 3.3}},
      {20, "Ten inserts and ten erases: still 90 % faster", {1.5, 2.3}}};
  for (const RatioClaim& part : parts) {
    claims.push_back(with({.where = "4.1, Figure 9",
                           .says = part.says,
                           .what = fmt::format("batch / segmented, {} events", part.x),
                           .band = part.band,
                           .why_less = costs + kCheapPass,
                           .why_more = costs + kDearPass},
                          results.times_faster(figure::k9, part.x, claimed::kBatchCell, claimed::kSegmentedCell)));
  }
  claims.push_back(with({.where = "4.1, Figure 9",
                         .says = "The cut-off is slightly less than 80 events",
                         .what = "events from which on segmented takes longer than batch",
                         .band = {55, 100},
                         .why_less = costs,
                         .why_more = costs,
                         .digits = 0},
                        results.crossing(figure::k9, claimed::kSegmentedCell, claimed::kBatchCell)));
  claims.push_back(with({.where = "4.1, Figure 9",
                         .says = "A further event costs batch less than it costs segmented lists",
                         .what = "segmented / batch, time per further event from 40 to 200 events",
                         .band = {.low = 1},
                         .why_less = "An event costs batch more: all that its sweep sets hold is tested."},
                        quotient(slope(results, figure::k9, claimed::kSegmentedCell, 40, 200),
                                 slope(results, figure::k9, claimed::kBatchCell, 40, 200))));
  add_presorted(claims, results);
}

void add_conclusions(std::vector<Claim>& claims, const Results& results) {
  std::optional<double> most;
  const auto consider = [&](const char* figure, const std::string& batch, const std::string& segmented) {
    for (const Entry* entry : results.series(figure, segmented)) {
      const auto ratio = results.times_faster(figure, entry->x, batch, segmented);
      if (ratio) most = std::max(most.value_or(0), ratio->median);
    }
  };
  consider(figure::k8, claimed::kBatchCell, claimed::kSegmentedCell);
  consider(figure::k9, claimed::kBatchCell, claimed::kSegmentedCell);
  consider(figure::k10, claimed::kBatchGrid, claimed::kSegmentedGrid);
  consider(figure::k11, claimed::kBatchGrid, claimed::kSegmentedGrid);
  // The most of one figure says nothing of the others.
  for (const char* const figure : {figure::k8, figure::k9, figure::k10, figure::k11}) {
    if (results.systems(figure).empty()) most.reset();
  }
  claims.push_back(with({.where = "4.3",
                         .says = "Inserts and erases several times faster than by batch methods",
                         .what = "batch / segmented, the most in Figures 8 to 11",
                         .band = {.low = 2},
                         .why_less = "The lines on Figures 8 to 11 tell where the time goes."},
                        most));
  claims.push_back({.where = "4.3",
                    .says = "The same in Scalable City, a large virtual world",
                    .what = "",
                    .beyond_us = "The program and its scenes are not to be had."});
}

}  // namespace

std::vector<Claim> claims_on_results(const Results& results) {
  std::vector<Claim> claims;
  for (const auto add : {add_correctness, add_implementation, add_figure_8, add_figure_9}) add(claims, results);
  for (Claim& claim : claims_on_grids(results)) claims.push_back(std::move(claim));
  add_conclusions(claims, results);
  return claims;
}

}  // namespace sweepgrid::study
