#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include <sweepgrid/engine/engine_core.hpp>
#include <sweepgrid/engine/envelope_filter.inl.hpp>
#include <sweepgrid/engine/envelopes.inl.hpp>
#include <sweepgrid/engine/follow_scene.inl.hpp>
#include <sweepgrid/engine/take_back.inl.hpp>
#include <sweepgrid/engine/validate.inl.hpp>
#include <sweepgrid/grid/grid_fit.inl.hpp>
#include <sweepgrid/grid/levels.inl.hpp>
#include <sweepgrid/sap/cell_kind.inl.hpp>

namespace sweepgrid {

namespace engine_core {

/// Tasks of a stage for each worker, so that the slowest does not keep the others waiting.
inline constexpr std::size_t kTasksPerWorker = 16;
/// Blocks of objects for each worker: fewer, because each has a queue to every shard of a grid.
inline constexpr std::size_t kBlocksPerWorker = 3;
/// Estimated cost, in about nanoseconds, below which a task is not worth its own start.
inline constexpr std::uint64_t kSmallestTask = 8192;

/// Share of objects that must have changed for cells to ask for boxes instead of being told.
inline constexpr double kDenseShare = 0.4;

template <class Scalar, int Dim>
void require_valid(const Config& config) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("sweepgrid: Config::" + what); };
  if (config.cell_population && *config.cell_population < 1) {
    refuse("cell_population is " + std::to_string(*config.cell_population) + ", but must be at least 1");
  }
  if (config.cell_size && !(*config.cell_size > 0 && std::isfinite(*config.cell_size))) {
    refuse("cell_size is " + std::to_string(*config.cell_size) + ", but must be positive and finite");
  }
  if (config.threads < 0) refuse("threads is " + std::to_string(config.threads) + ", but must not be negative");
  static_cast<void>(make_cell<Scalar, Dim>(config.cell));  // refuses bad cell options
}

}  // namespace engine_core

template <class Scalar, int Dim>
EngineCore<Scalar, Dim>::EngineCore(Config config, std::size_t event_bytes)
    : config_(std::move(config)), event_bytes_(event_bytes) {
  engine_core::require_valid<Scalar, Dim>(config_);
  executor_ = config_.executor ? config_.executor : make_executor(config_.threads);
  const auto workers = static_cast<std::size_t>(executor_->concurrency());
  if (counting()) {
    const std::size_t shards = workers == 1 ? 1 : std::bit_ceil(std::min<std::size_t>(4 * workers, 1024));
    shards_.resize(std::max<std::size_t>(2, shards));
    shard_shift_ = 64 - std::countr_zero(shards_.size());
  }
  graph_ = std::make_unique<StageGraph>(executor_);
  const auto stage = [this](const char* name, const std::vector<StageGraph::StageId>& after,
                            void (EngineCore::*plan)(std::vector<std::uint64_t>&),
                            void (EngineCore::*body)(std::size_t)) {
    return graph_->add(
        name, after, [this, plan](std::vector<std::uint64_t>& costs) { (this->*plan)(costs); },
        [this, body](std::size_t task) { (this->*body)(task); });
  };
  const auto routed = stage("route", {}, &EngineCore::plan_route, &EngineCore::route);
  const auto gathered = stage("gather", {routed}, &EngineCore::plan_gather, &EngineCore::gather);
  const auto drained = stage("drain", {gathered}, &EngineCore::plan_drain, &EngineCore::drain);
  reduce_stage_ = drained;
  // A barrier on purpose: a migrating pair yields -1 in the cell it leaves and +1 in the cell it enters, in either
  // order. Summed after all cells are drained this is 0; summed as cells finish it is a false end and begin.
  if (counting()) reduce_stage_ = stage("reduce", {drained}, &EngineCore::plan_reduce, &EngineCore::reduce);
}

template <class Scalar, int Dim>
EngineCore<Scalar, Dim>::~EngineCore() = default;

template <class Scalar, int Dim>
bool EngineCore<Scalar, Dim>::step() {
  if (broken_) restore_cells();
  counters_ = StepCounters{};
  regridding_ = false;
  idle_ = !objects_.anything_queued();
  if (idle_) {
    tasks_.clear();
    for (Shard& shard : shards_) shard.begins.clear(), shard.ends.clear();
  } else {
    budget_.start(config_.step_bytes.value_or(StepBudget::kUnlimited));
    try {
      graph_->run();
      finish_step();
    } catch (const OverBudget&) {
      take_back_step();
      ++refused_;
      return false;
    } catch (...) {
      take_back_step();
      throw;
    }
  }
  ++steps_;
  return true;
}

// ---- route: marked objects to cell queues, by block of objects

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::plan_route(std::vector<std::uint64_t>& costs) {
  follow_scene();
  objects_.nothing_queued();
  const std::uint32_t granules = objects_.granules();
  std::vector<std::uint32_t> marked;
  for (std::uint32_t granule = 0; granule < granules; ++granule) {
    if (regridding_ || relocating(granule) || objects_.granule_marked(granule)) marked.push_back(granule);
  }
  const bool rows = config_.cell.kind == CellKind::kRows || config_.cell.kind == CellKind::kAuto;
  dense_ = rows && !regridding_ && most_changed(marked);
  const auto workers = static_cast<std::size_t>(executor_->concurrency());
  const bool small = workers == 1 || marked.size() < 8;
  const std::size_t wanted = small ? 1 : std::min(marked.size(), engine_core::kBlocksPerWorker * workers);
  blocks_.resize(wanted);
  for (std::size_t b = 0; b < wanted; ++b) {
    RouteBlock& block = blocks_[b];
    const std::size_t first = b * marked.size() / wanted;
    const std::size_t end = (b + 1) * marked.size() / wanted;
    block.first_granule = marked[first];
    block.last_granule = marked[end - 1];
    block.counters = StepCounters{};
    block.retired.clear();
    block.relocated.clear();
    costs.push_back(end - first);
  }
  for (const GridIndex grid : levels_.live()) levels_.grid(grid).begin_step(wanted, dense_, &budget_);
}

// Judged by every 16th of the granules with a mark; in the others nothing has changed.
template <class Scalar, int Dim>
bool EngineCore<Scalar, Dim>::most_changed(const std::vector<std::uint32_t>& granules) const {
  const double marked = static_cast<double>(granules.size()) / std::max(1U, objects_.granules());
  if (marked <= engine_core::kDenseShare) return false;
  std::size_t seen = 0;
  std::size_t changed = 0;
  for (std::size_t i = 0; i < granules.size(); i += 16) {
    const ObjectId first = granules[i] * Objects::kGranule;
    const ObjectId end = std::min(objects_.bound() - first, Objects::kGranule) + first;
    for (ObjectId object = first; object < end; ++object) {
      changed += (objects_.state(object) & Objects::kUpdated) != 0 ? 1 : 0;
    }
    seen += end - first;
  }
  return marked * static_cast<double>(changed) > engine_core::kDenseShare * static_cast<double>(seen);
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::route(std::size_t block) {
  RouteBlock& out = blocks_[block];
  for (const GridIndex grid : levels_.live()) levels_.grid(grid).begin_block(block);
  for (std::uint32_t granule = out.first_granule; granule <= out.last_granule; ++granule) {
    if (!regridding_ && !relocating(granule) && !objects_.granule_marked(granule)) continue;
    route_granule(block, granule);
  }
  out.calls = 0;
  for (const GridIndex grid : levels_.live()) {
    levels_.grid(grid).end_block(block);
    out.calls += levels_.grid(grid).calls(block);
  }
}

// First the objects, then what is to be done with them: so their records can be on their way to the cache meanwhile.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::route_granule(std::size_t block, std::uint32_t granule) {
  constexpr std::uint64_t kOnes = ~std::uint64_t{0} / 0xff;  // 1 in each byte
  constexpr std::uint64_t kTops = 0x80 * kOnes;
  objects_.unmark_granule(granule);
  const ObjectId first = granule * Objects::kGranule;
  const std::uint32_t count = std::min(objects_.bound() - first, Objects::kGranule);
  const std::uint8_t wanted = regridding_ || relocating(granule) ? 0xff : Objects::kQueued;
  const std::uint8_t* const states = &objects_.state(first);  // a granule is contiguous
  std::array<std::uint8_t, Objects::kGranule> chosen;
  std::uint32_t used = 0;
  constexpr std::uint32_t kWord = sizeof(std::uint64_t);
  for (std::uint32_t i = 0; i < count; i += kWord) {
    std::uint64_t bytes = 0;
    std::memcpy(&bytes, states + i, std::min(kWord, count - i));
    bytes &= wanted * kOnes;
    // The top bit of each byte that is not 0.
    std::uint64_t marked = (bytes | ((bytes & ~kTops) + ~kTops)) & kTops;
    for (; marked != 0; marked &= marked - 1) {
      chosen[used++] = static_cast<std::uint8_t>(i + static_cast<std::uint32_t>(std::countr_zero(marked)) / 8);
    }
  }
  Record* const records = &objects_.record(first);
  RouteBlock& out = blocks_[block];
  constexpr std::uint32_t kAhead = 12;
  for (std::uint32_t i = 0; i < std::min(kAhead, used); ++i) __builtin_prefetch(&records[chosen[i]], 1);
  for (std::uint32_t i = 0; i < used; ++i) {
    if (i + kAhead < used) __builtin_prefetch(&records[chosen[i + kAhead]], 1);
    route_object(block, first + chosen[i], records[chosen[i]], out);
  }
}

template <class Scalar, int Dim>
inline void EngineCore<Scalar, Dim>::route_object(std::size_t block, ObjectId object, Record& record, RouteBlock& out) {
  std::uint8_t& state = objects_.state(object);
  if ((state & Objects::kQueued) == Objects::kUpdated) {
    ++out.counters.updates;
    note_change(record, state);
    route_moved(block, object, record, out);
    state = Objects::kLive;
  } else if ((state & Objects::kQueued) != 0) {
    const bool erased = (state & Objects::kErased) != 0;
    if ((state & Objects::kInserted) == 0) {
      note_change(record, state);
      ++out.counters.erases;
      if (!regridding_) levels_.grid(record.grid).route_erase(block, object, record.before);
      show(block, object, record.grid, &record.before, nullptr);
    } else if (!erased) {
      note_change(record, state);
      ++out.counters.inserts;
      record.grid = levels_.home(LevelsType::width(record.box));
      levels_.grid(record.grid).route_insert(block, object, record.box);
      show(block, object, record.grid, nullptr, &record.box);
    }
    if (erased) {
      objects_.retire(object);
      out.retired.push_back(object);
      return;
    }
    state = Objects::kLive;
  } else if (regridding_) {
    levels_.grid(record.grid).route_insert(block, object, record.box);
  }
  if (relocating(object / Objects::kGranule)) relocate(block, object, record, out);
}

template <class Scalar, int Dim>
inline void EngineCore<Scalar, Dim>::note_change(Record& record, std::uint8_t state) const {
  record.change = state;
  record.changed_at = steps_ + 1;
  record.grid_before = record.grid;
}

template <class Scalar, int Dim>
inline void EngineCore<Scalar, Dim>::route_moved(std::size_t block, ObjectId object, Record& record, RouteBlock& out) {
  const double width = LevelsType::width(record.box);
  GridType& grid = levels_.grid(record.grid);
  if (regridding_) {
    grid.route_insert(block, object, record.box);
  } else if (levels_.holds(record.grid, width)) {
    out.counters.migrations += grid.route_update(block, object, record.before, record.box) ? 1 : 0;
    if (levels_.live().size() > 1) show(block, object, record.grid, &record.before, &record.box);
  } else {  // too wide for its grid: it leaves for another, and the two sides of the step are shown apart
    ++out.counters.migrations;
    grid.route_erase(block, object, record.before);
    show(block, object, record.grid, &record.before, nullptr);
    record.grid = levels_.home(width);
    levels_.grid(record.grid).route_insert(block, object, record.box);
    show(block, object, record.grid, nullptr, &record.box);
  }
}

// Shows a changed object to the other grids. In coarser ones it meets everybody; in finer ones only those that rest,
// for the others are shown to its own grid.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::show(std::size_t block, ObjectId object, GridIndex home, const BoxType* before,
                                   const BoxType* after) {
  for (const GridIndex other : levels_.live()) {
    if (other == home) continue;
    levels_.grid(other).route_visit(block, object, before, after, !levels_.coarser(other, home));
  }
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::relocate(std::size_t block, ObjectId object, const Record& record, RouteBlock& out) {
  const GridIndex home = levels_.home(LevelsType::width(record.box));
  if (home == record.grid) return;
  levels_.grid(record.grid).route_detach(block, object, record.box);
  levels_.grid(home).route_attach(block, object, record.box);
  out.relocated.emplace_back(object, home);
}

// ---- gather: each cell's calls together, by shard

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::plan_gather(std::vector<std::uint64_t>& costs) {
  std::size_t used = 0;
  for (const GridIndex grid : levels_.live()) {
    for (std::size_t shard = 0; shard < levels_.grid(grid).shards(); ++shard) {
      if (used == gathers_.size()) gathers_.emplace_back();
      gathers_[used].grid = grid;
      gathers_[used].shard = shard;
      ++used;
    }
  }
  gathers_.resize(used);
  costs.assign(used, 1);
  std::uint64_t calls = 0;
  for (const RouteBlock& block : blocks_) calls += block.calls;
  counters_.cell_ops = calls;
  const auto workers = static_cast<std::uint64_t>(executor_->concurrency());
  const std::uint64_t work = 16 * std::max<std::uint64_t>(calls, dense_ ? 2 * objects_.size() : 0);
  task_cost_ = workers == 1 ? ~std::uint64_t{0}
                            : std::max(engine_core::kSmallestTask, work / (engine_core::kTasksPerWorker * workers));
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::gather(std::size_t index) {
  GatherTask& task = gathers_[index];
  GridType& grid = levels_.grid(task.grid);
  grid.gather(task.shard);
  task.cuts.clear();
  task.costs.clear();
  task.met = 0;
  task.ops = 0;
  std::uint64_t cost = 0;
  const auto cells = grid.active(task.shard);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto& cell = cells[i];
    const std::uint64_t ops = cell.call_count + (dense_ ? cell.population : 0);
    const std::uint64_t own = ops * (8 + cell.population / 8) + 8;
    if (cost > 0 && cost + own > task_cost_) {
      task.cuts.push_back(i);
      task.costs.push_back(std::exchange(cost, 0));
    }
    cost += own;
    task.met += static_cast<double>(ops) * cell.population;
    task.ops += ops;
  }
  if (cost > 0) {
    task.cuts.push_back(cells.size());
    task.costs.push_back(cost);
  }
}

// ---- drain: calls to overlap deltas, by active cell

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::plan_drain(std::vector<std::uint64_t>& costs) {
  std::size_t used = 0;
  double met = 0;
  std::uint64_t ops = 0;
  for (const GatherTask& gathered : gathers_) {
    const auto cells = levels_.grid(gathered.grid).active(gathered.shard);
    counters_.cells_drained += cells.size();
    if (gathered.grid == levels_.finest()) met += gathered.met, ops += gathered.ops;
    std::size_t first = 0;
    for (std::size_t i = 0; i < gathered.cuts.size(); ++i) {
      if (used == tasks_.size()) {
        // With witness counts, deltas are written a second time, by shard.
        const std::size_t copies = counting() ? 2 : 1;
        tasks_.emplace_back().out.deltas = DeltaList(budget_, copies * sizeof(OverlapDelta));
      }
      DrainTask& task = tasks_[used++];
      task.grid = gathered.grid;
      task.shard = gathered.shard;
      task.cells = cells.subspan(first, gathered.cuts[i] - first);
      first = gathered.cuts[i];
      costs.push_back(gathered.costs[i]);
    }
  }
  tasks_.resize(used);
  if (!relocation_.wanted) regrid_.observe(met, ops);  // half a scene in new cells says little
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::drain(std::size_t index) {
  DrainTask& task = tasks_[index];
  task.out.clear();
  levels_.grid(task.grid).drain(task.shard, task.cells, StepBoxes<Scalar, Dim>(objects_, steps_ + 1), task.out);
  task.out.deltas.charge();
  counting() ? partition(task) : report(task);
}

// Deltas to events, while they are still in the worker's cache.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::report(DrainTask& task) {
  task.begins.clear();
  task.ends.clear();
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
      if (verdict == Verdict::kBegin) task.begins.push_back(pair);
      if (verdict == Verdict::kEnd) task.ends.push_back(pair);
    }
  }
  budget_.charge((task.begins.size() + task.ends.size()) * event_bytes_);
}

// Deltas into slots by shard, while they are still in the worker's cache.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::partition(DrainTask& task) const {
  const auto& deltas = task.out.deltas;
  task.shard_end.assign(shards_.size() + 1, 0);
  for (const OverlapDelta& delta : deltas) ++task.shard_end[shard_of(delta.pair) + 1];
  for (std::size_t shard = 1; shard <= shards_.size(); ++shard) task.shard_end[shard] += task.shard_end[shard - 1];
  task.by_shard.resize(deltas.size());
  // Each entry walks from its shard's begin to its end, and so becomes what its name says.
  for (const OverlapDelta& delta : deltas) task.by_shard[task.shard_end[shard_of(delta.pair)]++] = delta;
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
  shard.begins.clear();
  shard.ends.clear();
  WitnessTable before;
  if (regridding_) std::swap(before, shard.witnesses);
  for (const DrainTask& task : tasks_) {
    const std::size_t first = index == 0 ? 0 : task.shard_end[index - 1];
    shard.witnesses.apply(std::span(task.by_shard).subspan(first, task.shard_end[index] - first));
  }
  shard.witnesses.finish(shard.begins, shard.ends);
  if (regridding_) keep_changes(shard, before);
  budget_.charge((shard.begins.size() + shard.ends.size()) * event_bytes_);
}

// After a regrid. Every pair began in the new grid. What the old grid's table does not know has really begun, and what
// only it knows has ended.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::keep_changes(Shard& shard, const WitnessTable& before) {
  std::erase_if(shard.begins, [&](PairKey pair) { return before.count(pair) > 0; });
  std::vector<PairKey> old_pairs;
  before.append_pairs(old_pairs);
  for (const PairKey pair : old_pairs) {
    if (shard.witnesses.count(pair) == 0) shard.ends.push_back(pair);
  }
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::finish_step() {
  std::size_t retired = 0;
  for (const RouteBlock& block : blocks_) retired += block.retired.size();
  objects_.reserve_free(retired);
  for (const DrainTask& task : tasks_) {
    counters_.cells += task.out.counters;
    levels_.grid(task.grid).drop_empty(task.shard, task.out.emptied);
  }
  // Nothing throws from here on, so the step cannot be taken back any more.
  for (RouteBlock& block : blocks_) {
    counters_ += block.counters;
    objects_.free_ids(block.retired);
    block.retired.clear();  // lest a step that fails before it routes frees them again
    for (const auto& [object, home] : block.relocated) objects_.record(object).grid = home;
  }
  last_changed_ = counters_.inserts + counters_.updates + counters_.erases;
  if (levels_.live().size() > 1)
    objects_.set_widest(std::min(objects_.widest(), levels_.drop_empty(!relocation_.wanted)));
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::count_events(std::size_t begins, std::size_t ends) {
  counters_.begins = begins;
  counters_.ends = ends;
  pairs_ += begins;
  pairs_ -= ends;
  total_ += counters_;
}

// ---- what clients ask for

template <class Scalar, int Dim>
std::vector<PairKey> EngineCore<Scalar, Dim>::pairs() const {
  if (broken_) throw std::logic_error("sweepgrid: pairs after a step() that ran out of memory, before another step()");
  std::vector<PairKey> pairs;
  if (counting()) {
    for (const Shard& shard : shards_) shard.witnesses.append_pairs(pairs);
  } else {
    for_each_pair([&](PairKey pair) { pairs.push_back(pair); });
  }
  return pairs;
}

template <class Scalar, int Dim>
Stats EngineCore<Scalar, Dim>::stats() const {
  Stats stats;
  stats.step = counters_;
  stats.total = total_;
  stats.steps = steps_;
  stats.refused = refused_;
  for (StageGraph::StageId stage = 0; stage < graph_->size(); ++stage) {
    stats.stages.push_back({graph_->name(stage), idle_ ? 0 : graph_->seconds(stage)});
  }
  stats.objects = objects_.size();
  stats.pairs = pairs_;
  stats.cell_size = levels_.cell_size();
  stats.grids = levels_.live().size();
  for (const GridIndex index : levels_.live()) {
    const GridType& grid = levels_.grid(index);
    stats.cells += grid.cell_count();
    stats.bytes_cells += grid.cell_bytes();
    stats.bytes_queues += grid.queue_bytes();
  }
  stats.bytes_objects = objects_.bytes();
  for (const DrainTask& task : tasks_) {
    stats.bytes_queues += (task.out.deltas.capacity() + task.by_shard.capacity()) * sizeof(OverlapDelta) +
                          (task.begins.capacity() + task.ends.capacity()) * sizeof(PairKey);
  }
  for (const Shard& shard : shards_) {
    stats.bytes_witnesses +=
        shard.witnesses.bytes() + (shard.begins.capacity() + shard.ends.capacity()) * sizeof(PairKey);
  }
  return stats;
}

}  // namespace sweepgrid
