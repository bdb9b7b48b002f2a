#pragma once

#include <algorithm>
#include <utility>

#include <sweepgrid/engine/engine_core.hpp>
#include <sweepgrid/engine/reporter.hpp>
#include <sweepgrid/grid/levels.inl.hpp>

namespace sweepgrid {

// The stages between calls and events.

namespace engine_core {

/// Tasks of a stage for each worker, so that the slowest does not keep the others waiting.
inline constexpr std::size_t kTasksPerWorker = 16;
/// Estimated cost, in about nanoseconds, below which a task is not worth its own start.
inline constexpr std::uint64_t kSmallestTask = 8192;

}  // namespace engine_core

// ---- gather: each cell's calls together, by shard

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::plan_gather(std::vector<std::uint64_t>& costs) {
  gathers_.restart();
  if (sweeping_) return;
  for (const GridIndex grid : levels_.live()) {
    for (std::size_t shard = 0; shard < levels_.grid(grid).shards(); ++shard) {
      GatherTask& task = gathers_.add();
      task.grid = grid;
      task.shard = shard;
    }
  }
  costs.assign(gathers_.size(), 1);
  std::uint64_t calls = 0;
  for (const RouteBlock& block : blocks_) calls += block.calls;
  counters_.cell_ops = calls;
  const std::uint64_t work = 16 * calls;
  task_cost_ = workers() == 1 ? ~std::uint64_t{0}
                              : std::max(engine_core::kSmallestTask, work / (engine_core::kTasksPerWorker * workers()));
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::gather(std::size_t index) {
  GatherTask& task = gathers_[index];
  GridType& grid = levels_.grid(task.grid);
  grid.gather(task.shard);
  task.restart();
  std::uint64_t cost = 0;
  const auto cells = grid.active(task.shard);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto& cell = cells[i];
    const std::uint64_t ops = cell.call_count;
    const std::uint64_t own = ops * (8 + cell.population / 8) + 8;
    if (cost > 0 && cost + own > task_cost_) {
      task.cuts.items.push_back(i);
      task.costs.items.push_back(std::exchange(cost, 0));
    }
    cost += own;
    task.met += static_cast<double>(ops) * cell.population;
    task.ops += ops;
  }
  if (cost > 0) {
    task.cuts.items.push_back(cells.size());
    task.costs.items.push_back(cost);
  }
  task.note_step();
}

// ---- drain: calls to overlap deltas, by active cell

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::plan_drain(std::vector<std::uint64_t>& costs) {
  tasks_.restart();
  if (sweeping_) return;
  double met = 0;
  std::uint64_t ops = 0;
  for (const GatherTask& gathered : gathers_) {
    const auto cells = levels_.grid(gathered.grid).active(gathered.shard);
    counters_.cells_drained += cells.size();
    if (gathered.grid == levels_.finest()) met += gathered.met, ops += gathered.ops;
    std::size_t first = 0;
    for (std::size_t i = 0; i < gathered.cuts.items.size(); ++i) {
      DrainTask& task = tasks_.add([this] {
        DrainTask made;
        // With witness counts, deltas are written a second time, by shard.
        made.out.deltas = DeltaList(budget_, (counting() ? 2 : 1) * sizeof(OverlapDelta));
        return made;
      });
      task.grid = gathered.grid;
      task.shard = gathered.shard;
      task.cells = cells.subspan(first, gathered.cuts.items[i] - first);
      first = gathered.cuts.items[i];
      costs.push_back(gathered.costs.items[i]);
    }
  }
  regrid_.observe(met, ops);
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::drain(std::size_t index) {
  DrainTask& task = tasks_[index];
  task.restart();
  levels_.grid(task.grid).drain(task.shard, task.cells, StepBoxes<Scalar, Dim>(objects_, steps_ + 1), task.out);
  task.out.deltas.charge();
  counting() ? partition(task) : report(task);
  task.note_step();
}

// Deltas to events, while they are still in the worker's cache.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::report(DrainTask& task) {
  const Reporter<Scalar, Dim> reporter(objects_, levels_, steps_ + 1);
  constexpr std::size_t kAhead = 8;
  const auto& deltas = task.out.deltas;
  for (std::size_t i = 0; i < std::min(kAhead, deltas.size()); ++i) reporter.prefetch(deltas[i].pair);
  std::size_t i = 0;
  for (const auto& run : task.out.runs) {
    for (; i < run.end; ++i) {
      if (i + kAhead < deltas.size()) reporter.prefetch(deltas[i + kAhead].pair);
      const PairKey pair = deltas[i].pair;
      const Verdict verdict = reporter.judge(pair, task.grid, run.cell);
      if (verdict == Verdict::kBegin) task.begins.items.push_back(pair);
      if (verdict == Verdict::kEnd) task.ends.items.push_back(pair);
    }
  }
  budget_.charge((task.begins.items.size() + task.ends.items.size()) * event_bytes_);
}

// Deltas into slots by shard, while they are still in the worker's cache.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::partition(DrainTask& task) const {
  const auto& deltas = task.out.deltas;
  task.shard_end.assign(shards_.size() + 1, 0);
  for (const OverlapDelta& delta : deltas) ++task.shard_end[shard_of(delta.pair) + 1];
  for (std::size_t shard = 1; shard <= shards_.size(); ++shard) task.shard_end[shard] += task.shard_end[shard - 1];
  task.by_shard.items.resize(deltas.size());
  // Each entry walks from its shard's begin to its end, and so becomes what its name says.
  for (const OverlapDelta& delta : deltas) task.by_shard.items[task.shard_end[shard_of(delta.pair)]++] = delta;
  task.shard_end.pop_back();
}

// ---- reduce: deltas to witness counts to events, by shard

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::plan_reduce(std::vector<std::uint64_t>& costs) {
  costs.assign(shards_.size(), 1);
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::reduce(std::size_t index) {
  Shard& shard = shards_[index];
  shard.restart();
  WitnessTable before;
  if (regridding_) std::swap(before, shard.witnesses);
  for (const DrainTask& task : tasks_) {
    const std::size_t first = index == 0 ? 0 : task.shard_end[index - 1];
    shard.witnesses.apply(std::span(task.by_shard.items).subspan(first, task.shard_end[index] - first));
  }
  shard.witnesses.finish(shard.begins.items, shard.ends.items);
  if (regridding_) keep_changes(shard, before);
  budget_.charge((shard.begins.items.size() + shard.ends.items.size()) * event_bytes_);
  shard.note_step();
}

// After a regrid. Every pair began in the new grid. What the old grid's table does not know has really begun, and what
// only it knows has ended.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::keep_changes(Shard& shard, const WitnessTable& before) {
  std::erase_if(shard.begins.items, [&](PairKey pair) { return before.count(pair) > 0; });
  std::vector<PairKey> old_pairs;
  before.append_pairs(old_pairs);
  for (const PairKey pair : old_pairs) {
    if (shard.witnesses.count(pair) == 0) shard.ends.items.push_back(pair);
  }
}

}  // namespace sweepgrid
