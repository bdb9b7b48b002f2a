#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <sweepgrid/engine/stats.hpp>

namespace sweepgrid {

/// Whether a step is to sweep all objects or to go through cells, by exact counts of what steps of both kinds took, so
/// that it is the same on every machine. Cells that were given up have to be made anew, which costs as much as three
/// sweeps or so: the way that is taken is left when the other one would have saved that much since. Only a scene's
/// first cells are made at once, for nothing tells yet that much will change again.
class MethodChoice {
 public:
  /// Before a step that changes so many of `objects` objects. `cells`: there are some.
  [[nodiscard]] bool sweep(std::size_t changed, std::size_t objects, bool cells) {
    const double sweep = sweep_cost_ * static_cast<double>(objects);
    const double through_cells = change_cost_ * static_cast<double>(changed);
    const double saved = cells ? through_cells - sweep : sweep - through_cells;
    saved_ = std::max(0.0, saved_ + saved);
    const bool leave = saved_ > (had_cells_ ? kMakeCells * static_cast<double>(objects) : 0);
    if (leave) saved_ = 0;
    had_cells_ = had_cells_ || cells || leave;
    return cells == leave;
  }

  /// What a sweep of so many objects counted: entries in rows, and members that they met.
  void note_sweep(std::size_t objects, std::uint64_t entries, std::uint64_t meetings) {
    if (objects < kFew) return;
    sweep_cost_ = kObject + (kEntry * static_cast<double>(entries) + kMeeting * static_cast<double>(meetings)) /
                                static_cast<double>(objects);
  }

  /// What a step through cells counted. Few changes say little.
  void note_cells(const StepCounters& step) {
    const std::uint64_t changed = step.inserts + step.updates + step.erases;
    if (changed < kFew) return;
    change_cost_ =
        (kCellOp * static_cast<double>(step.cell_ops) + kBoxTest * static_cast<double>(step.cells.box_tests) +
         kDelta * static_cast<double>(step.cells.deltas)) /
        static_cast<double>(changed);
  }

 private:
  static constexpr std::uint64_t kFew = 64;
  // Measured, in about nanoseconds; see engine/README.md.
  static constexpr double kObject = 5;
  static constexpr double kEntry = 7;
  static constexpr double kMeeting = 0.12;
  static constexpr double kCellOp = 40;
  static constexpr double kBoxTest = 0.25;
  static constexpr double kDelta = 10;
  static constexpr double kMakeCells = 45;  // for each object

  double sweep_cost_ = 15;   // for each object
  double change_cost_ = 80;  // for each change
  double saved_ = 0;         // that the other way would have, since the latest change
  bool had_cells_ = false;
};

}  // namespace sweepgrid
