// Section 3: subdivision, batch insertion and removal, segmented interval lists, events.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "study/figures/claimed_systems.hpp"
#include "study/figures/figure_plans.hpp"
#include "study/figures/paper_claims.hpp"

namespace sweepgrid::study {
namespace {

constexpr double kEventsPerStep = 20;  // of figure::kInsertWork

double swaps_per_event(const Entry& entry) { return entry.per_step(entry.work.cells.swaps) / kEventsPerStep; }
double tests_per_event(const Entry& entry) { return entry.per_step(entry.work.cells.box_tests) / kEventsPerStep; }

std::optional<double> swaps_at_last(const Results& results, const std::string& system) {
  const auto entries = results.series(figure::kInsertWork, system);
  return entries.empty() ? std::nullopt : std::optional(swaps_per_event(*entries.back()));
}

// The x whose time is least; absent when nothing was measured.
std::optional<double> best_x(const Results& results, const std::string& figure, const std::string& system) {
  const auto entries = results.series(figure, system);
  const auto best = std::min_element(entries.begin(), entries.end(), [](const Entry* a, const Entry* b) {
    return median_seconds(*a) < median_seconds(*b);
  });
  return best == entries.end() ? std::nullopt : std::optional((*best)->x);
}

const Entry* closest(const Results& results, const std::string& figure, const std::string& system, double x) {
  const auto entries = results.series(figure, system);
  const auto distance = [x](const Entry* entry) { return std::abs(std::log(entry->x / x)); };
  const auto found = std::min_element(entries.begin(), entries.end(),
                                      [&](const Entry* a, const Entry* b) { return distance(a) < distance(b); });
  return found == entries.end() ? nullptr : *found;
}

// How many times as long as at the best x it takes at that closest to `x`.
std::string loss_text(const Results& results, const std::string& figure, const std::string& system, double x) {
  const Entry* there = closest(results, figure, system, x);
  const auto best = best_x(results, figure, system);
  if (there == nullptr || !best) return "";
  const double loss = median_seconds(*there) / median_seconds(*results.find(figure, system, *best));
  return fmt::format("{} takes {:.2f} times as long as the best.", there->x, loss);
}

// What the size of cells changes, by exact counts.
std::string population_text(const Results& results, const std::string& system) {
  const Entry* there = closest(results, figure::kPopulation, system, 300);
  const auto best = best_x(results, figure::kPopulation, system);
  if (there == nullptr || !best) return "";
  const Entry* at_best = results.find(figure::kPopulation, system, *best);
  const auto per_update = [](const Entry* entry, std::uint64_t count) {
    return static_cast<double>(count) / static_cast<double>(entry->work.updates);
  };
  return fmt::format(
      "{} An update takes {:.1f} swaps and {:.2f} operations on cells at the best, {:.1f} and {:.2f} there.",
      loss_text(results, figure::kPopulation, system, 300), per_update(at_best, at_best->work.cells.swaps),
      per_update(at_best, at_best->work.cell_ops), per_update(there, there->work.cells.swaps),
      per_update(there, there->work.cell_ops));
}

void add_population(std::vector<Claim>& claims, const Results& results) {
  for (const CellKind kind : {CellKind::kSegmented, CellKind::kBatch}) {
    const std::string system = system_name::grid(kind);
    const std::string text = population_text(results, system);
    claims.push_back(with({.where = "3.1, 4.2",
                           .says = "About 300 objects per cell are best",
                           .what = fmt::format("objects per cell that cost least, {}", system),
                           .band = {150, 600},
                           .why_less = text + " Operations on cells cost little here beside swaps.",
                           .why_more = text + " Operations on cells cost much here beside swaps.",
                           .digits = 0},
                          best_x(results, figure::kPopulation, system)));
  }
}

void add_batch(std::vector<Claim>& claims, const Results& results) {
  claims.push_back(
      with({.where = "3.2.1",
            .says = "Batch insertion and removal: O(k (m log m + n)); inserts are merged in, not swapped in",
            .what = "swaps per event in the largest cell, exact count",
            .band = {0, 0},
            .why_more = "Endpoints are swapped into place."},
           swaps_at_last(results, claimed::kBatchCell)));
  claims.push_back(with({.where = "3.2.1",
                         .says = "Batch: the time of few events is at most linear in n",
                         .what = "exponent of time over n, 20 events",
                         .band = {.high = 1.1},
                         .why_more = "What is touched outgrows the caches; the counts above do not grow."},
                        results.law(figure::kInsertWork, claimed::kBatchCell, median_seconds)));
  claims.push_back(
      with({.where = "3.2.1",
            .says = "Batch is like plain sweep and prune when few events occur",
            .what = "classic / batch, one insert and one erase, 5 % of 3000 moving",
            .band = {0.67, 1.5},
            .why_less = "The pass of the batch kind does more per endpoint.",
            .why_more = "Even a few inserts cost the classic kind O(n) swaps each, which the merge saves."},
           results.times_faster(figure::k9, 2, claimed::kClassicCell, claimed::kBatchCell)));
  claims.push_back(
      with({.where = "3.2.1",
            .says = "Batch smoothly becomes the sweeping plane when many events occur",
            .what = "batch / plane, all of 3000 objects replaced in each step",
            .band = {0.67, 1.5},
            .why_less = "The plane sorts all endpoints by comparing, batch only looks for those that changed.",
            .why_more = "Erasing and inserting all takes two sets of endpoints through the merge, while the "
                        "plane sorts once."},
           results.times_faster(figure::kReplaced, 1, claimed::kBatchCell, system_name::one_cell(CellKind::kPlane))));
}

// What a box test takes in the smallest and the largest cell.
std::string time_per_test_text(const Results& results) {
  const auto entries = results.series(figure::kInsertWork, claimed::kSegmentedCell);
  if (entries.empty()) return "";
  const auto per_test = [](const Entry& entry) {
    return 1e9 * median_seconds(entry) / entry.per_step(entry.work.cells.box_tests);
  };
  return fmt::format(
      " Per test a step takes {:.0f} ns with {} objects and {:.0f} ns with {}: the boxes outgrow the caches.",
      per_test(*entries.front()), entries.front()->x, per_test(*entries.back()), entries.back()->x);
}

void add_segmented(std::vector<Claim>& claims, const Results& results) {
  const auto tests = results.law(figure::kInsertWork, claimed::kSegmentedCell, tests_per_event);
  const std::string tests_text =
      tests ? fmt::format(
                  "Box tests per event grow with the power {:.2f} of n: an inserted box must be tested against "
                  "all that it meets on one axis, n^(2/3) of them at constant density, which the paper's "
                  "count leaves out.",
                  tests->exponent)
            : "";
  claims.push_back(with({.where = "3.2.2",
                         .says = "Segmented lists: swaps per insert or erase are limited to a constant, a segment's "
                                 "length for each of its 2k endpoints",
                         .what = "swaps per event in the largest cell, exact count",
                         .band = {0, 6 * 32},
                         .why_more = "Swaps leave their segments."},
                        swaps_at_last(results, claimed::kSegmentedCell)));
  claims.push_back(with({.where = "3.2.2",
                         .says = "Segmented lists: O(k m log n) in all",
                         .what = "exponent of box tests per event over n, exact counts",
                         .band = {-0.1, 0.2},
                         .why_less = "Tests fall with n.",
                         .why_more = tests_text + " In a grid n is the cell's, and it is a constant (below)."},
                        tests));
  claims.push_back(with({.where = "3.2.2",
                         .says = "Segmented lists: the time of few events hardly grows with n",
                         .what = "exponent of time over n, 20 events",
                         .band = {-0.1, 0.35},
                         .why_less = "Time falls with n.",
                         .why_more = tests_text + time_per_test_text(results)},
                        results.law(figure::kInsertWork, claimed::kSegmentedCell, median_seconds)));
  claims.push_back(
      with({.where = "3.1",
            .says = "In a grid insertion and removal fall from O(k m n) to O(k m)",
            .what = "exponent of swaps per event over n from 8000 on, classic cells in a grid, exact counts",
            .band = {-0.2, 0.2},
            .why_less = "Larger scenes have fewer objects per cell.",
            .why_more = "Cells of small scenes hold fewer objects than those of large ones."},
           results.law(figure::kInsertWork, claimed::kClassicGrid, swaps_per_event, claimed::kLeastGrid)));
  claims.push_back(
      with({.where = "3.1, 3.2.2",
            .says = "In a grid the tests of segmented lists do not grow with n either",
            .what = "exponent of box tests per event over n from 8000 on, segmented cells in a grid, exact counts",
            .band = {-0.2, 0.2},
            .why_less = "Larger scenes have fewer objects per cell.",
            .why_more = "Cells of small scenes hold fewer objects than those of large ones."},
           results.law(figure::kInsertWork, claimed::kSegmentedGrid, tests_per_event, claimed::kLeastGrid)));
}

void add_segment_size(std::vector<Claim>& claims, const Results& results) {
  const auto events = best_x(results, figure::kSegments, system_name::kSegmentsEvents);
  const auto sort = best_x(results, figure::kSegments, system_name::kSegmentsSort);
  const std::string loss = loss_text(results, figure::kSegments, system_name::kSegmentsEvents, 32);
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
  const auto last = results.series(figure::k11, claimed::kSegmentedGrid);
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
                        results.law(figure::k11, claimed::kSegmentedGrid, per_update_and_event)));
  std::optional<double> quiet;
  for (const Entry* entry : results.series(figure::kQuiet, claimed::kSegmentedGrid)) {
    const Work& work = entry->work;
    quiet = static_cast<double>(work.cells.swaps + work.cells.box_tests + work.cells.deltas + work.cells_drained);
  }
  claims.push_back(with({.where = "3.3",
                         .says = "Objects at rest cost nothing, however many pairs they make",
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
