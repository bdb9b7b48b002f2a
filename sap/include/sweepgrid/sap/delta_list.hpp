#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <sweepgrid/sap/high_water.hpp>
#include <sweepgrid/sap/overlap_delta.hpp>
#include <sweepgrid/sap/scratch_memory.hpp>
#include <sweepgrid/sap/step_budget.hpp>

namespace sweepgrid {

/// Where cells write overlap deltas: a vector that charges a budget whenever it grows, because one cell with n objects
/// at one point has n^2 / 2 of them to write. Lends them the memory that they need meanwhile, too.
class DeltaList {
 public:
  /// Without a budget: as long as memory lasts.
  DeltaList() = default;
  explicit DeltaList(StepBudget& budget, std::uint64_t bytes_each = sizeof(OverlapDelta))
      : budget_(&budget), bytes_each_(bytes_each) {}

  /// Throws OverBudget.
  void push_back(const OverlapDelta& delta) {
    if (deltas_.size() == deltas_.capacity()) [[unlikely]]
      grow();
    deltas_.push_back(delta);
  }
  /// Charges what was not charged yet: to be called when the list is complete. Throws OverBudget.
  void charge() {
    if (budget_ != nullptr) budget_->charge((deltas_.size() - charged_) * bytes_each_);
    charged_ = deltas_.size();
  }
  /// Keeps the memory.
  void clear() {
    deltas_.clear();
    charged_ = 0;
  }

  /// What a drain needs beside its deltas. Whoever uses it resets it.
  [[nodiscard]] ScratchMemory& scratch() { return scratch_; }

  /// Ends a step: empties the list, and memory beyond what HighWater allows goes back.
  void note_step() {
    water_.note(deltas_.size());
    release();
    scratch_.note_step();
  }
  /// As note_step() for so many steps in which the list was not used.
  void pass(std::size_t steps) {
    water_.pass(steps);
    release();
    scratch_.pass(steps);
  }

  /// Heap bytes held.
  [[nodiscard]] std::size_t bytes() const { return deltas_.capacity() * sizeof(OverlapDelta) + scratch_.bytes(); }

  [[nodiscard]] std::size_t size() const { return deltas_.size(); }
  [[nodiscard]] bool empty() const { return deltas_.empty(); }
  [[nodiscard]] std::size_t capacity() const { return deltas_.capacity(); }
  [[nodiscard]] const OverlapDelta& operator[](std::size_t i) const { return deltas_[i]; }
  [[nodiscard]] auto begin() { return deltas_.begin(); }
  [[nodiscard]] auto end() { return deltas_.end(); }
  [[nodiscard]] auto begin() const { return deltas_.begin(); }
  [[nodiscard]] auto end() const { return deltas_.end(); }

 private:
  void release() {
    water_.release(deltas_);
    charged_ = 0;
  }
  [[gnu::noinline]] void grow() {
    charge();
    deltas_.reserve(std::max<std::size_t>(16, 2 * deltas_.capacity()));
  }

  std::vector<OverlapDelta> deltas_;
  StepBudget* budget_ = nullptr;
  std::uint64_t bytes_each_ = 0;
  std::size_t charged_ = 0;
  ScratchMemory scratch_;
  HighWater water_;
};

}  // namespace sweepgrid
