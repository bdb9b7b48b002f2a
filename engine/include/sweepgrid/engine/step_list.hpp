#pragma once

#include <cstddef>
#include <vector>

#include <sweepgrid/sap/high_water.hpp>

namespace sweepgrid {

/// A list that every step fills anew, and that is read until the next one begins. Keeps its memory as HighWater allows.
template <class T>
struct StepList {
  std::vector<T> items;
  HighWater most;

  /// Begins a step: empties the list.
  void restart() { most.release(items); }
  /// Ends the step.
  void note_step() { most.note(items.size()); }
  /// As restart() and note_step() for so many steps in which it stayed empty.
  void pass(std::size_t steps) {
    most.pass(steps);
    restart();
  }
  /// Heap bytes held.
  [[nodiscard]] std::size_t bytes() const { return items.capacity() * sizeof(T); }
};

}  // namespace sweepgrid
