#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <sweepgrid/engine/stats.hpp>
#include <sweepgrid/engine/step_list.hpp>
#include <sweepgrid/sap/ids.hpp>
#include <sweepgrid/sap/row_sweep.hpp>

/// What the tasks of a step that sweeps work on and leave behind.
namespace sweepgrid::sweep_tasks {

/// An object in a row, in the order in which objects were looked at.
struct Entry {
  std::uint32_t bin;  // counted through the rows of the part
  std::uint32_t object;
  std::uint32_t reach;  // the last bin of the row that the object is in, and below it row_marks and marks
};

/// In the reach of an entry or a member, beside those of row_marks.
namespace marks {
// Before the step and after it an object was that far apart that its two boxes are members of their own.
inline constexpr std::uint32_t kGone = 1;
inline constexpr std::uint32_t kBorn = 2;
// The box does not lie in the object's record.
inline constexpr std::uint32_t kCopied = 4;
static_assert((kGone | kBorn | kCopied) == row_marks::kFree);
}  // namespace marks

/// The entries that a block of objects has in a part of the rows.
template <class Value>
struct Arrivals {
  StepList<Entry> entries;
  StepList<Value> copies;  // boxes of the entries that are copied, in their order

  void restart() { entries.restart(), copies.restart(); }
  void note_step() { entries.note_step(), copies.note_step(); }
  void pass(std::size_t steps) { entries.pass(steps), copies.pass(steps); }
  [[nodiscard]] std::size_t bytes() const { return entries.bytes() + copies.bytes(); }
};

/// A block of objects as it is put into rows.
template <class Value>
struct Bin {
  std::uint32_t first_granule = 0;
  std::uint32_t last_granule = 0;
  StepCounters counters;
  bool overflown = false;  // has more entries than all blocks should; what is here is not all
  StepList<ObjectId> retired;
  std::vector<Arrivals<Value>> parts;

  void restart() {
    counters = StepCounters{};
    overflown = false;
    retired.restart();
    for (auto& part : parts) part.restart();
  }
  void note_step() {
    retired.note_step();
    for (auto& part : parts) part.note_step();
  }
  void pass(std::size_t steps) {
    retired.pass(steps);
    for (auto& part : parts) part.pass(steps);
  }
  [[nodiscard]] std::size_t bytes() const {
    std::size_t total = retired.bytes() + parts.capacity() * sizeof(parts[0]);
    for (const auto& part : parts) total += part.bytes();
    return total;
  }
};

/// A part of the rows, and what a sweep has found there.
struct Sweep {
  StepList<PairKey> begins;
  StepList<PairKey> ends;
  std::uint64_t meetings = 0;  // members that members met

  void restart() {
    begins.restart(), ends.restart();
    meetings = 0;
  }
  void note_step() { begins.note_step(), ends.note_step(); }
  void pass(std::size_t steps) { begins.pass(steps), ends.pass(steps); }
  [[nodiscard]] std::size_t bytes() const { return begins.bytes() + ends.bytes(); }
};

/// What a worker needs for a task.
template <class Value, int Dim>
struct Scratch {
  // Objects that are put into rows at once.
  struct Batch {
    using Kernel = RowSweep<Value, Dim>;
    static constexpr std::size_t kRoom = Kernel::kPlaced + Kernel::kPadding;
    const Value* boxes[kRoom];
    std::uint32_t objects[kRoom];
    std::uint32_t far[kRoom];
    Value copies[kRoom * Kernel::kValues];
    typename Kernel::Entries entries;
  };
  Batch batch;
  StepList<std::uint32_t> bins;  // by bin: how many members are in it or before it
  StepList<RowMember<Value>> members;
  SweepScratch sweep;

  void note_step() { bins.note_step(), members.note_step(), sweep.note_step(); }
  void pass(std::size_t steps) { bins.pass(steps), members.pass(steps), sweep.pass(steps); }
  [[nodiscard]] std::size_t bytes() const { return bins.bytes() + members.bytes() + sweep.bytes(); }
};

}  // namespace sweepgrid::sweep_tasks
