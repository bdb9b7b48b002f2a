// Section 3: subdivision, batch insertion and removal, segmented interval lists, events.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "study/figures/figure_plans.hpp"
#include "study/figures/paper_claims.hpp"

namespace sweepgrid::study {
namespace {

const std::string kClassicCell = system_name::one_cell(CellKind::kClassic);
const std::string kBatchCell = system_name::one_cell(CellKind::kBatch);
const std::string kSegmentedCell = system_name::one_cell(CellKind::kSegmented);
const std::string kClassicGrid = system_name::grid(CellKind::kClassic);
const std::string kSegmentedGrid = system_name::grid(CellKind::kSegmented);

constexpr double kEventsPerStep = 20;  // of figure::kInsertWork

double swaps_per_event(const Entry& entry) { return entry.per_step(entry.work.cells.swaps) / kEventsPerStep; }
double tests_per_event(const Entry& entry) { return entry.per_step(entry.work.cells.box_tests) / kEventsPerStep; }

// The x whose time is least; absent when nothing was measured.
std::optional<double> best_x(const Results& results, const std::string& figure, const std::string& system) {
  const auto entries = results.series(figure, system);
  const auto best = std::min_element(entries.begin(), entries.end(), [](const Entry* a, const Entry* b) {
    return median_seconds(*a) < median_seconds(*b);
  });
  return best == entries.end() ? std::nullopt : std::optional((*best)->x);
}

// How many times as long as at the best x it takes at that closest to `x`.
double loss_at(const Results& results, const std::string& figure, const std::string& system, double x) {
  const auto entries = results.series(figure, system);
  double least = INFINITY;
  const Entry* closest = nullptr;
  for (const Entry* entry : entries) {
    least = std::min(least, median_seconds(*entry));
    const auto distance = [x](const Entry* e) { return std::abs(std::log(e->x / x)); };
    if (closest == nullptr || distance(entry) < distance(closest)) closest = entry;
  }
  return closest == nullptr ? NAN : median_seconds(*closest) / least;
}

void add_population(std::vector<Claim>& claims, const Results& results) {
  for (const CellKind kind : {CellKind::kSegmented, CellKind::kBatch}) {
    const std::string system = system_name::grid(kind);
    const std::string loss = fmt::format("Cells of about 300 cost {:.2f} times as much as the best.",
                                         loss_at(results, figure::kPopulation, system, 300));
    claims.push_back(with({.where = "3.1, 4.2",
                           .says = "About 300 objects per cell are best",
                           .what = fmt::format("objects per cell that cost least, {}", system),
                           .band = {150, 600},
                           .why_less = loss + " Swaps per update fall with the cell's width, and a cell costs little "
                                              "beside them here: it is found by hashing and kept in few allocations.",
                           .why_more = loss + " Objects in several cells, which are drained in each, weigh more here "
                                              "than swaps.",
                           .digits = 0},
                          best_x(results, figure::kPopulation, system)));
  }
}

void add_batch(std::vector<Claim>& claims, const Results& results) {
  const auto swaps = [&]() -> std::optional<double> {
    const auto entries = results.series(figure::kInsertWork, kBatchCell);
    return entries.empty() ? std::nullopt : std::optional(swaps_per_event(*entries.back()));
  };
  claims.push_back(
      with({.where = "3.2.1",
            .says = "Batch insertion and removal: O(k (m log m + n)); inserts are merged in, not swapped in",
            .what = "swaps per event in the largest cell, exact count",
            .band = {0, 0},
            .why_more = "Endpoints are swapped into place."},
           swaps()));
  claims.push_back(with({.where = "3.2.1",
                         .says = "... so for few events the time is at most linear in n",
                         .what = "exponent of time over n, 20 events",
                         .band = {.high = 1.1},
                         .why_more = "What is touched outgrows the caches; the counts above do not grow."},
                        results.law(figure::kInsertWork, kBatchCell, median_seconds)));
  claims.push_back(
      with({.where = "3.2.1",
            .says = "Batch is like plain sweep and prune when few events occur",
            .what = "classic / batch, one insert and one erase, 5 % of 3000 moving",
            .band = {0.67, 1.5},
            .why_less = "The pass of the batch kind does more per endpoint.",
            .why_more = "Even a few inserts cost the classic kind O(n) swaps each, which the merge saves."},
           results.times_faster(figure::k9, 2, kClassicCell, kBatchCell)));
  claims.push_back(
      with({.where = "3.2.1",
            .says = "... and smoothly becomes the sweeping plane when many events occur",
            .what = "batch / plane, all of 3000 objects replaced in each step",
            .band = {0.67, 1.5},
            .why_less = "The plane sorts all endpoints by comparing, batch only looks for those that changed.",
            .why_more = "Erasing and inserting all takes two sets of endpoints through the merge, while the "
                        "plane sorts once."},
           results.times_faster(figure::kReplaced, 1, kBatchCell, system_name::one_cell(CellKind::kPlane))));
}

void add_segmented(std::vector<Claim>& claims, const Results& results) {
  const auto tests = results.law(figure::kInsertWork, kSegmentedCell, tests_per_event);
  const std::string tests_text =
      tests ? fmt::format(
                  "Box tests per event grow with the power {:.2f} of n: an inserted box must be tested against "
                  "all that it meets on one axis, n^(2/3) of them at constant density, which the paper's "
                  "count leaves out.",
                  tests->exponent)
            : "";
  claims.push_back(with({.where = "3.2.2",
                         .says = "Segmented lists: swaps per insert or erase are limited to a constant",
                         .what = "exponent of swaps per event over n, exact counts",
                         .band = {-0.1, 0.1},
                         .why_less = "Swaps fall with n.",
                         .why_more = "Swaps leave their segments."},
                        results.law(figure::kInsertWork, kSegmentedCell, swaps_per_event)));
  claims.push_back(with({.where = "3.2.2",
                         .says = "... O(k m log n) in all",
                         .what = "exponent of box tests per event over n, exact counts",
                         .band = {-0.1, 0.2},
                         .why_less = "Tests fall with n.",
                         .why_more = tests_text + " In a grid n is the cell's, and it is a constant (below)."},
                        tests));
  claims.push_back(with({.where = "3.2.2",
                         .says = "... so for few events the time hardly grows with n",
                         .what = "exponent of time over n, 20 events",
                         .band = {-0.1, 0.35},
                         .why_less = "Time falls with n.",
                         .why_more = tests_text},
                        results.law(figure::kInsertWork, kSegmentedCell, median_seconds)));
  claims.push_back(with({.where = "3.1",
                         .says = "In a grid insertion and removal fall from O(k m n) to O(k m)",
                         .what = "exponent of swaps per event over n, classic cells in a grid, exact counts",
                         .band = {-0.2, 0.2},
                         .why_less = "Larger scenes have fewer objects per cell.",
                         .why_more = "Cells of small scenes hold fewer objects than those of large ones."},
                        results.law(figure::kInsertWork, kClassicGrid, swaps_per_event)));
  claims.push_back(with({.where = "3.1, 3.2.2",
                         .says = "... also what segmented lists test",
                         .what = "exponent of box tests per event over n, segmented cells in a grid, exact counts",
                         .band = {-0.2, 0.2},
                         .why_less = "Larger scenes have fewer objects per cell.",
                         .why_more = "Cells of small scenes hold fewer objects than those of large ones."},
                        results.law(figure::kInsertWork, kSegmentedGrid, tests_per_event)));
}

void add_segment_size(std::vector<Claim>& claims, const Results& results) {
  const auto events = best_x(results, figure::kSegments, system_name::kSegmentsEvents);
  const auto sort = best_x(results, figure::kSegments, system_name::kSegmentsSort);
  const std::string loss = fmt::format("32 endpoints cost {:.2f} times as much as the best.",
                                       loss_at(results, figure::kSegments, system_name::kSegmentsEvents, 32));
  claims.push_back(with({.where = "3.2.2",
                         .says = "Segments of about 2^5 endpoints are best for inserts and erases",
                         .what = "capacity that costs least",
                         .band = {16, 64},
                         .why_less = loss,
                         .why_more = loss + " Endpoints of 8 bytes that are moved and compared in one go make long "
                                            "segments cheap; the paper calls this dependent on the machine.",
                         .digits = 0},
                        events));
  const auto ratio = events && sort ? std::optional(*sort / *events) : std::nullopt;
  claims.push_back(with({.where = "3.2.2",
                         .says = "Sorting likes somewhat longer segments",
                         .what = "capacity that costs least when sorting / when inserting and erasing",
                         .band = {.low = 1},
                         .why_less = "A swap stays in its segment most of the time even in short ones."},
                        ratio));
}

double per_update_and_event(const Entry& entry) {
  return static_cast<double>(entry.work.cells.deltas) / static_cast<double>(entry.work.updates + entry.work.events);
}

void add_events(std::vector<Claim>& claims, const Results& results) {
  const auto last = results.series(figure::k11, kSegmentedGrid);
  std::optional<double> changes;
  if (!last.empty()) {
    for (const Results::Played& played : results.all()) {
      if (played.figure != figure::k11 || played.contest.entries.back().x != last.back()->x) continue;
      changes = last.back()->per_step(last.back()->work.events) / static_cast<double>(played.contest.pairs);
    }
  }
  claims.push_back(with({.where = "3.3",
                         .says = "Changes of overlap are very few beside all overlaps where motion is coherent",
                         .what = "events per step / overlapping pairs, largest scene of Figure 11, exact counts",
                         .band = {.high = 0.1},
                         .why_more = "At this speed and share of movers a pair lasts only a few steps.",
                         .digits = 3},
                        changes));
  claims.push_back(with({.where = "3.3",
                         .says = "Output takes O(u + e)",
                         .what = "exponent over n of overlap deltas per update and event, Figure 11, exact counts",
                         .band = {-0.1, 0.1},
                         .why_less = "Deltas grow more slowly than updates and events.",
                         .why_more = "Deltas grow faster than updates and events: pairs in several cells."},
                        results.law(figure::k11, kSegmentedGrid, per_update_and_event)));
  std::optional<double> quiet;
  for (const Entry* entry : results.series(figure::kQuiet, kSegmentedGrid)) {
    const Work& work = entry->work;
    quiet = static_cast<double>(work.cells.swaps + work.cells.box_tests + work.cells.deltas + work.cells_drained);
  }
  claims.push_back(with({.where = "3.3",
                         .says = "... so objects at rest cost nothing, however many pairs they make",
                         .what = "swaps, box tests, deltas and cells drained while nothing moves, exact count",
                         .band = {0, 0},
                         .why_more = "Cells without updates are drained.",
                         .digits = 0},
                        quiet));
}

}  // namespace

std::vector<Claim> claims_on_enhancements(const Results& results) {
  std::vector<Claim> claims;
  add_population(claims, results);
  add_batch(claims, results);
  add_segmented(claims, results);
  add_segment_size(claims, results);
  add_events(claims, results);
  return claims;
}

}  // namespace sweepgrid::study
