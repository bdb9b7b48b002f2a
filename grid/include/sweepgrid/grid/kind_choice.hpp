#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <sweepgrid/sap/cell_kind.hpp>
#include <sweepgrid/sap/sap_counters.hpp>

namespace sweepgrid {

/// Chooses the kind of one cell while it is used. Only cells of many objects are worth it: with few, rows are always
/// fastest. Costs are measured in exact counts, weighted by what each takes (sap/README.md), not by a clock, so that a
/// scene is treated alike on every run.
///
/// A cell of many objects tries a batch sweep and prune for as many drains as it has just judged, and keeps it when it
/// is clearly cheaper than rows. Each trial that fails doubles the time to the next. Segmented lists are no candidate:
/// in cells of a grid they were nowhere faster than batches (bench/README.md).
class KindChoice {
 public:
  /// Cells of fewer objects than this have rows. Going back takes a quarter less, so that no cell wavers.
  static constexpr std::size_t kManyObjects = 256;

  /// What a drain of `ops` ops among `population` objects took; `work` is what it added to the counters.
  /// Returns the kind that the cell should have from now on.
  CellKind observe(CellKind kind, std::size_t population, std::size_t ops, const SapCounters& work) {
    if (population < kManyObjects * 3 / 4) {
      *this = KindChoice();
      return CellKind::kRows;
    }
    cost_ += cost(kind, ops, work);
    ops_ += ops;
    if (++drains_ < kWindow) return kind;
    const double per_op = cost_ / static_cast<double>(std::max<std::uint64_t>(1, ops_));
    cost_ = 0, ops_ = 0, drains_ = 0;
    if (kind == CellKind::kRows) return judge_rows(per_op, population);
    return judge_trial(per_op);
  }

 private:
  static constexpr int kWindow = 8;             // drains
  static constexpr double kClearly = 0.8;       // of the other kind's cost: what is clearly cheaper
  static constexpr double kFewMove = 0.1;       // share of a cell's objects below which segments beat batches
  static constexpr int kLongestWait = 1 << 12;  // windows

  // In nanoseconds, about.
  static double cost(CellKind kind, std::size_t ops, const SapCounters& work) {
    const auto tests = static_cast<double>(work.box_tests);
    const double deltas = 12.0 * static_cast<double>(work.deltas);
    if (kind == CellKind::kRows) return 15.0 * static_cast<double>(ops) + 0.18 * tests + deltas;
    return 60.0 * static_cast<double>(ops) + static_cast<double>(work.swaps) + 2.0 * tests + deltas;
  }

  CellKind judge_rows(double per_op, std::size_t population) {
    rows_cost_ = per_op;
    return population < kManyObjects || --wait_ > 0 ? CellKind::kRows : CellKind::kBatch;
  }

  CellKind judge_trial(double per_op) {
    if (per_op < kClearly * rows_cost_) {
      next_wait_ = 1;
      return CellKind::kBatch;
    }
    wait_ = next_wait_;
    next_wait_ = std::min(2 * next_wait_, kLongestWait);
    return CellKind::kRows;
  }

  double cost_ = 0;  // of the running window
  std::uint64_t ops_ = 0;
  int drains_ = 0;
  double rows_cost_ = 0;  // per op, when the cell last had rows
  int wait_ = 1;          // windows to the next trial
  int next_wait_ = 1;
};

}  // namespace sweepgrid
