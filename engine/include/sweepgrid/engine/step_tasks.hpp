#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <sweepgrid/engine/stats.hpp>
#include <sweepgrid/engine/step_list.hpp>
#include <sweepgrid/engine/witness_table.hpp>
#include <sweepgrid/grid/grid.hpp>
#include <sweepgrid/grid/levels.hpp>
#include <sweepgrid/sap/ids.hpp>

/// What the tasks of a step work on and leave behind, with the lists that they keep from step to step: see StepItems.
namespace sweepgrid::step_tasks {

/// A block of objects as it is routed.
struct Route {
  // Of the granules that the step looks at: [first, last).
  std::size_t first = 0;
  std::size_t last = 0;
  StepCounters counters;
  std::uint64_t calls = 0;
  StepList<ObjectId> retired;

  void restart() {
    counters = StepCounters{};
    calls = 0;
    retired.restart();
  }
  void note_step() { retired.note_step(); }
  void pass(std::size_t steps) { retired.pass(steps); }
  [[nodiscard]] std::size_t bytes() const { return retired.bytes(); }
};

/// A shard of a grid with queued calls, and how its active cells are cut into tasks.
struct Gather {
  GridIndex grid = 0;
  std::size_t shard = 0;
  StepList<std::size_t> cuts;     // where a task's cells end
  StepList<std::uint64_t> costs;  // of the tasks
  double met = 0;                 // residents that ops met, summed over ops
  std::uint64_t ops = 0;

  void restart() {
    cuts.restart(), costs.restart();
    met = 0;
    ops = 0;
  }
  void note_step() { cuts.note_step(), costs.note_step(); }
  void pass(std::size_t steps) { cuts.pass(steps), costs.pass(steps); }
  [[nodiscard]] std::size_t bytes() const { return cuts.bytes() + costs.bytes(); }
};

/// Active cells that one task drains, and what comes of it.
template <class Scalar, int Dim>
struct Drain {
  GridIndex grid = 0;
  std::size_t shard = 0;
  std::span<const typename Grid<Scalar, Dim>::ActiveCell> cells;
  DrainOutput<Scalar, Dim> out;
  // With single reporters.
  StepList<PairKey> begins;
  StepList<PairKey> ends;
  // With witness counts: deltas sorted by shard.
  StepList<OverlapDelta> by_shard;
  std::vector<std::size_t> shard_end;

  void restart() {
    out.clear();
    begins.restart(), ends.restart(), by_shard.restart();
  }
  void note_step() { out.note_step(), begins.note_step(), ends.note_step(), by_shard.note_step(); }
  void pass(std::size_t steps) { out.pass(steps), begins.pass(steps), ends.pass(steps), by_shard.pass(steps); }
  [[nodiscard]] std::size_t bytes() const {
    return out.bytes() + begins.bytes() + ends.bytes() + by_shard.bytes() + shard_end.capacity() * sizeof(shard_end[0]);
  }
};

/// A part of the witness counts, and the events that come of it.
struct Shard {
  WitnessTable witnesses;
  StepList<PairKey> begins;
  StepList<PairKey> ends;

  void restart() { begins.restart(), ends.restart(); }
  void note_step() { witnesses.note_step(), begins.note_step(), ends.note_step(); }
  void pass(std::size_t steps) { witnesses.pass(steps), begins.pass(steps), ends.pass(steps); }
  [[nodiscard]] std::size_t bytes() const { return witnesses.bytes() + begins.bytes() + ends.bytes(); }
};

}  // namespace sweepgrid::step_tasks
