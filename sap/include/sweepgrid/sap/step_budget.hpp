#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace sweepgrid {

/// Thrown where the lists of a step would become longer than its budget. The engine catches it.
class OverBudget : public std::length_error {
 public:
  OverBudget() : std::length_error("sweepgrid: the lists of a step are over its budget") {}
};

/// Bytes that the lists of one step may take: what goes into lists is charged by its size, not by the capacity of the
/// lists. So the sum, and whether it exceeds the limit, is the same for any number of threads; a step that is certain
/// to exceed it ends early.
///
/// Thread-safety: many may charge at once.
class StepBudget {
 public:
  static constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

  /// Begins a step. Not beside charge().
  void start(std::uint64_t limit) {
    limit_ = limit;
    charged_.store(0, std::memory_order_relaxed);
  }

  /// Throws OverBudget when all charges since start() exceed the limit. Does nothing without one.
  void charge(std::uint64_t bytes) {
    if (limit_ == kUnlimited) return;
    if (charged_.fetch_add(bytes, std::memory_order_relaxed) + bytes > limit_) throw OverBudget();
  }

 private:
  std::uint64_t limit_ = kUnlimited;
  std::atomic<std::uint64_t> charged_ = 0;
};

}  // namespace sweepgrid
