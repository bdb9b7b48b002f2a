// Section 2: how plain sweep and prune grows, and what it pays for inserts and erases.
#include <cmath>

#include <fmt/format.h>

#include "study/figures/claimed_systems.hpp"
#include "study/figures/figure_plans.hpp"
#include "study/figures/paper_claims.hpp"

namespace sweepgrid::study {
namespace {

double plain_swaps_per_step(const Entry& entry) { return entry.per_step(entry.work.cells.swaps); }
double swaps_per_update(const Entry& entry) {
  return static_cast<double>(entry.work.cells.swaps) / static_cast<double>(entry.work.updates);
}

std::string exponent_text(const std::optional<PowerLaw>& law) {
  return law ? fmt::format("{:.2f}", law->exponent) : "unknown";
}

// The power between the two largest sizes; empty when there are none.
std::string late_power(const Results& results) {
  const auto entries = results.series(figure::k2, claimed::kClassicCell);
  if (entries.size() < 2) return "";
  const Entry& last = *entries.back();
  const Entry& before = *entries[entries.size() - 2];
  const double power = std::log(median_seconds(last) / median_seconds(before)) / std::log(last.x / before.x);
  return fmt::format("from {} to {} objects the power is {:.2f} already", before.x, last.x, power);
}

std::string swaps_beside(const std::optional<PowerLaw>& swaps) {
  return fmt::format("swaps, which are counted exactly, grow with the power {}", exponent_text(swaps));
}

void add_growth(std::vector<Claim>& claims, const Results& results) {
  const auto time = results.law(figure::k2, claimed::kClassicCell, median_seconds);
  const auto swaps = results.law(figure::k2, claimed::kClassicCell, plain_swaps_per_step);
  claims.push_back(with(
      {.where = "2.1, Figure 2",
       .says = "Time of plain sweep and prune, all moving, grows with the power 1.76 of n, close to 5/3",
       .what = "exponent of time",
       .band = {1.57, 1.86},
       .why_less = fmt::format("In small scenes the pass over the lists, linear in n, takes much of the time; {}; {}.",
                               late_power(results), swaps_beside(swaps)),
       .why_more = fmt::format("The lists outgrow the caches, so a swap costs more in larger scenes; {}.",
                               swaps_beside(swaps))},
      time));
  claims.push_back(with({.where = "2.1",
                         .says = "Swaps grow as u k n^(1-1/k): in 3 dimensions, all moving, with the power 5/3",
                         .what = "exponent of swaps, exact counts",
                         .band = {1.617, 1.717},
                         .why_less = "Small scenes have relatively more objects that turn back at the walls.",
                         .why_more = "The scene is denser on its axes than the estimate assumes."},
                        swaps));
  claims.push_back(with({.where = "2.1",
                         .says = "Swaps grow as u k n^(1-1/k): in 2 dimensions, all moving, with the power 3/2",
                         .what = "exponent of swaps, exact counts",
                         .band = {1.45, 1.55},
                         .why_less = "Small scenes have relatively more objects that turn back at the walls.",
                         .why_more = "The scene is denser on its axes than the estimate assumes."},
                        results.law(figure::kFlat, claimed::kClassicCell, plain_swaps_per_step)));
}

void add_local_sort(std::vector<Claim>& claims, const Results& results) {
  claims.push_back(
      with({.where = "2",
            .says = "A local sort beats a global one when few objects move",
            .what = "global / local, 3000 objects, 5 % moving",
            .band = {.low = 1},
            .why_less = "The pass over the lists is cheaper here than finding the places of the movers."},
           results.times_faster(figure::kSorts, 3000, system_name::kFewMovingGlobal, system_name::kFewMovingLocal)));
}

void add_plain_events(std::vector<Claim>& claims, const Results& results) {
  claims.push_back(
      with({.where = "2.1",
            .says = "An insert or erase in plain sweep and prune takes O(n) swaps on each axis (the term mnk)",
            .what = "exponent of swaps per event over n, exact counts",
            .band = {0.9, 1.1},
            .why_less = "Endpoints enter the lists closer to their places.",
            .why_more = "Swaps of other objects are mixed in."},
           results.law(figure::kInsertWork, claimed::kClassicCell, plain_swaps_per_step)));
}

void add_subdivision(std::vector<Claim>& claims, const Results& results) {
  claims.push_back(
      with({.where = "3, 3.1",
            .says = "Subdivision makes swaps linear in the updates: u k, whatever n",
            .what = "exponent of swaps per update over n from 8000 on, exact counts",
            .band = {-0.05, 0.1},
            .why_less = "Larger scenes have relatively fewer cells at the walls.",
            .why_more = "In small scenes cells cannot be as wide as wanted, and objects at the walls are in "
                        "fewer cells; this fades as the scene grows."},
           results.law(figure::k2, claimed::kClassicGrid, swaps_per_update, claimed::kLeastGrid)));
  claims.push_back(with({.where = "3.1",
                         .says = "So the time of a grid grows linearly",
                         .what = "exponent of time, from 8000 objects on",
                         .band = {0.9, 1.15},
                         .why_less = "Fixed costs of a step weigh on small scenes.",
                         .why_more = "Swaps do not grow faster (the line above); what is touched per step outgrows the "
                                     "caches."},
                        results.law(figure::k2, claimed::kClassicGrid, median_seconds, claimed::kLeastGrid)));
  claims.push_back(with({.where = "1",
                         .says = "Subdivision is an order of magnitude or more faster in large environments",
                         .what = "one cell / grid, batch, at the largest scene that one cell was given",
                         .band = {.low = 10},
                         .why_less = "The ratio grows with n; at this size it has not got there yet."},
                        results.times_faster_at_last(figure::k2, system_name::one_cell(CellKind::kBatch),
                                                     system_name::grid(CellKind::kBatch))));
}

void add_others(std::vector<Claim>& claims, const Results&) {
  claims.push_back({.where = "2, 3.2.2",
                    .says = "I-COLLIDE's bit matrix takes O(n²) space; kinetic sweep and prune needs known paths; "
                            "stabbing counters and markers are slower to insert into",
                    .what = "",
                    .beyond_us = "Other authors' programs, which are not built here."});
  claims.push_back({.where = "3.1",
                    .says = "Subdivision lends itself to threads",
                    .what = "",
                    .beyond_us = "One thread here, as in the paper's section 4."});
}

}  // namespace

std::vector<Claim> claims_on_growth(const Results& results) {
  std::vector<Claim> claims;
  add_local_sort(claims, results);
  add_growth(claims, results);
  add_plain_events(claims, results);
  add_subdivision(claims, results);
  add_others(claims, results);
  return claims;
}

}  // namespace sweepgrid::study
