#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <sweepgrid/engine/engine_core.hpp>
#include <sweepgrid/engine/validate.inl.hpp>
#include <sweepgrid/grid/grid.inl.hpp>
#include <sweepgrid/grid/grid_fit.inl.hpp>
#include <sweepgrid/sap/cell_kind.inl.hpp>

namespace sweepgrid {

namespace engine_core {

/// Tasks per worker that a stage is cut into: enough to balance, few enough to cost nothing.
inline constexpr std::size_t kTasksPerWorker = 8;
/// Estimated cost (about an endpoint's visit each) below which another task is not worth its spawn.
inline constexpr std::uint64_t kSmallestTask = 4096;

template <class Scalar, int Dim>
void require_valid(const Config<Scalar, Dim>& config) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("sweepgrid: Config::" + what); };
  if (config.cell_population < 1) {
    refuse("cell_population is " + std::to_string(config.cell_population) + ", but must be at least 1");
  }
  if (config.cell_size && !(*config.cell_size > 0 && std::isfinite(*config.cell_size))) {
    refuse("cell_size is " + std::to_string(*config.cell_size) + ", but must be positive and finite");
  }
  if (config.bounds) {
    bool good = config.bounds->valid();
    for (int axis = 0; axis < Dim; ++axis) {
      good = good && std::isfinite(static_cast<double>(config.bounds->min[axis])) &&
             std::isfinite(static_cast<double>(config.bounds->max[axis]));
    }
    if (!good) refuse("bounds must be finite with min <= max on every axis");
  }
  if (config.threads < 0) refuse("threads is " + std::to_string(config.threads) + ", but must not be negative");
  static_cast<void>(make_cell<Scalar, Dim>(config.cell));  // refuses bad cell options
}

}  // namespace engine_core

template <class Scalar, int Dim>
EngineCore<Scalar, Dim>::EngineCore(ConfigType config) : config_(std::move(config)) {
  engine_core::require_valid(config_);
  executor_ = config_.executor ? config_.executor : make_executor(config_.threads);
  const auto workers = static_cast<std::size_t>(executor_->concurrency());
  const std::size_t shards = workers == 1 ? 1 : std::bit_ceil(std::min<std::size_t>(4 * workers, 1024));
  shards_.resize(std::max<std::size_t>(2, shards));
  shard_shift_ = 64 - std::countr_zero(shards_.size());
  graph_ = std::make_unique<StageGraph>(executor_);
  const auto stage = [this](const char* name, const std::vector<StageGraph::StageId>& after,
                            void (EngineCore::*plan)(std::vector<std::uint64_t>&),
                            void (EngineCore::*body)(std::size_t)) {
    return graph_->add(
        name, after, [this, plan](std::vector<std::uint64_t>& costs) { (this->*plan)(costs); },
        [this, body](std::size_t task) { (this->*body)(task); });
  };
  const auto routed = stage("route", {}, &EngineCore::plan_route, &EngineCore::route);
  const auto gathered = graph_->add(
      "gather", {routed}, [this](std::vector<std::uint64_t>& costs) { plan_gather(costs); },
      [this](std::size_t group) { grid_.gather(group); });
  const auto drained = stage("drain", {gathered}, &EngineCore::plan_drain, &EngineCore::drain);
  // A barrier on purpose: a migrating pair yields -1 in the cell it leaves and +1 in the cell it enters, in either
  // order. Summed after all cells are drained this is 0; summed as cells finish it is a false end and begin.
  reduce_stage_ = stage("reduce", {drained}, &EngineCore::plan_reduce, &EngineCore::reduce);
  if (fixed_grid()) {
    const auto extent = grid_fit::extent_of(*config_.bounds);
    grid_.reset(GridSpec<Scalar, Dim>(extent.lower, extent.upper, *config_.cell_size), config_.cell);
    gridded_ = true;
  }
}

template <class Scalar, int Dim>
EngineCore<Scalar, Dim>::~EngineCore() = default;

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::step() {
  counters_ = StepCounters{};
  regridding_ = false;
  idle_ = !objects_.anything_queued();
  if (!idle_) {
    graph_->run();
    finish_step();
  } else {
    for (Shard& shard : shards_) shard.begins.clear(), shard.ends.clear();
  }
  total_ += counters_;
  ++steps_;
}

// ---- route: marked objects to cell queues, by block of objects

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::plan_route(std::vector<std::uint64_t>& costs) {
  follow_scene();
  objects_.nothing_queued();
  const std::uint32_t granules = objects_.granules();
  std::vector<std::uint32_t> marked;
  for (std::uint32_t granule = 0; granule < granules; ++granule) {
    if (regridding_ || objects_.granule_marked(granule)) marked.push_back(granule);
  }
  const auto workers = static_cast<std::size_t>(executor_->concurrency());
  const bool small = workers == 1 || marked.size() < 8;
  const std::size_t wanted = small ? 1 : std::min(marked.size(), engine_core::kTasksPerWorker * workers);
  blocks_.resize(wanted);
  for (std::size_t b = 0; b < wanted; ++b) {
    RouteBlock& block = blocks_[b];
    const std::size_t first = b * marked.size() / wanted;
    const std::size_t end = (b + 1) * marked.size() / wanted;
    block.first_granule = marked[first];
    block.last_granule = marked[end - 1];
    block.counters = StepCounters{};
    block.outside_change = 0;
    block.retired.clear();
    costs.push_back(end - first);
  }
  grid_.begin_step(wanted, small ? 1 : std::bit_ceil(engine_core::kTasksPerWorker * workers));
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::route(std::size_t block) {
  RouteBlock& out = blocks_[block];
  for (std::uint32_t granule = out.first_granule; granule <= out.last_granule; ++granule) {
    if (!regridding_ && !objects_.granule_marked(granule)) continue;
    objects_.unmark_granule(granule);
    const ObjectId first = granule * Objects::kGranule;
    const ObjectId end = std::min(objects_.bound() - first, Objects::kGranule) + first;
    for (ObjectId object = first; object < end; ++object) {
      const std::uint8_t state = objects_.state(object);
      if ((state & Objects::kQueued) != 0 || (regridding_ && state != 0)) route_object(block, object, out);
    }
  }
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::route_object(std::size_t block, ObjectId object, RouteBlock& out) {
  std::uint8_t& state = objects_.state(object);
  auto& record = objects_.record(object);
  const bool was_inside_grid = !regridding_ && (state & Objects::kInserted) == 0;
  if ((state & Objects::kOutside) != 0 && !regridding_) --out.outside_change;
  if ((state & Objects::kErased) != 0) {
    if (was_inside_grid) grid_.route_erase(block, object, record.range);
    out.counters.erases += (state & Objects::kInserted) == 0 ? 1 : 0;
    objects_.retire(object);
    out.retired.push_back(object);
    return;
  }
  out.counters.inserts += (state & Objects::kInserted) != 0 ? 1 : 0;
  out.counters.updates += (state & (Objects::kInserted | Objects::kUpdated)) == Objects::kUpdated ? 1 : 0;
  if (was_inside_grid) {
    out.counters.migrations += grid_.route_update(block, object, record.box, record.range) ? 1 : 0;
  } else {
    grid_.route_insert(block, object, record.box, record.range);
  }
  const bool outside = grid_.spec().outside(record.box);
  out.outside_change += outside ? 1 : 0;
  state = static_cast<std::uint8_t>(Objects::kLive | (outside ? Objects::kOutside : 0));
}

// ---- gather: each cell's ops together, by group of cells

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::plan_gather(std::vector<std::uint64_t>& costs) {
  costs.assign(grid_.groups(), 1);
}

// ---- drain: ops to overlap deltas, by active cell

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::plan_drain(std::vector<std::uint64_t>& costs) {
  const auto cost = [](const auto& cell) {
    // A drain visits each op's endpoints, and often each resident's.
    return std::uint64_t{16} * cell.op_count + std::uint64_t{4} * cell.population + 64;
  };
  std::uint64_t total = 0;
  double met = 0;
  for (std::size_t group = 0; group < grid_.groups(); ++group) {
    for (const auto& cell : grid_.active(group)) {
      total += cost(cell);
      counters_.cell_ops += cell.op_count;
      met += static_cast<double>(cell.op_count) * cell.population;
      ++counters_.cells_drained;
    }
  }
  crowding_ = counters_.cell_ops == 0 ? 0 : met / static_cast<double>(counters_.cell_ops);
  const auto workers = static_cast<std::uint64_t>(executor_->concurrency());
  const std::uint64_t share =
      workers == 1 ? total + 1 : std::max(engine_core::kSmallestTask, total / (engine_core::kTasksPerWorker * workers));
  std::size_t used = 0;
  for (std::size_t group = 0; group < grid_.groups(); ++group) {
    const auto cells = grid_.active(group);
    for (std::size_t first = 0, end = 0; first < cells.size(); first = end) {
      std::uint64_t sum = 0;
      while (end < cells.size() && (sum == 0 || sum + cost(cells[end]) <= share)) sum += cost(cells[end++]);
      if (used == tasks_.size()) tasks_.emplace_back();
      tasks_[used].group = group;
      tasks_[used].cells = cells.subspan(first, end - first);
      ++used;
      costs.push_back(sum);
    }
  }
  tasks_.resize(used);
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::drain(std::size_t index) {
  DrainTask& task = tasks_[index];
  task.deltas.clear();
  task.counters = SapCounters{};
  const auto cells = task.cells;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i + 2 < cells.size()) grid_.prefetch(cells[i + 1], cells[i + 2]);
    grid_.drain(task.group, cells[i], task.deltas, task.counters);
  }
  partition(task);
}

// Deltas into slots by shard, while they are still in the worker's cache.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::partition(DrainTask& task) const {
  task.shard_end.assign(shards_.size() + 1, 0);
  for (const OverlapDelta& delta : task.deltas) ++task.shard_end[shard_of(delta.pair) + 1];
  for (std::size_t shard = 1; shard <= shards_.size(); ++shard) task.shard_end[shard] += task.shard_end[shard - 1];
  task.by_shard.resize(task.deltas.size());
  // Each entry walks from its shard's begin to its end, and so becomes what its name says.
  for (const OverlapDelta& delta : task.deltas) task.by_shard[task.shard_end[shard_of(delta.pair)]++] = delta;
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
  if (!regridding_) return;
  // Every pair began in the new grid. What the old grid's table does not know has really begun, and what only it knows
  // has ended.
  std::erase_if(shard.begins, [&](PairKey pair) { return before.count(pair) > 0; });
  std::vector<PairKey> old_pairs;
  before.append_pairs(old_pairs);
  for (const PairKey pair : old_pairs) {
    if (shard.witnesses.count(pair) == 0) shard.ends.push_back(pair);
  }
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::finish_step() {
  for (RouteBlock& block : blocks_) {
    counters_ += block.counters;
    outside_ += block.outside_change;
    objects_.free_ids(block.retired);
  }
  for (const DrainTask& task : tasks_) counters_.cells += task.counters;
  for (const Shard& shard : shards_) {
    counters_.begins += shard.begins.size();
    counters_.ends += shard.ends.size();
  }
  if (regridding_) {
    outside_at_fit_ = outside_;
    crowding_at_fit_ = 0;
  } else if (crowding_at_fit_ == 0) {
    crowding_at_fit_ = crowding_;
  }
}

// ---- the grid

// Twice or a quarter of the objects, or an eighth of them has left the bounds.
template <class Scalar, int Dim>
bool EngineCore<Scalar, Dim>::outgrown() const {
  const std::size_t objects = objects_.size();
  if (objects > 2 * objects_at_fit_ || 4 * objects + 64 < objects_at_fit_) return true;
  return !config_.bounds && 8 * (outside_ - outside_at_fit_) > static_cast<std::int64_t>(objects);
}

// The cells that ops go to have become twice as crowded.
template <class Scalar, int Dim>
bool EngineCore<Scalar, Dim>::crowded() const {
  return crowding_at_fit_ > 0 && crowding_ > 2 * std::max<double>(crowding_at_fit_, 2.0 * config_.cell_population);
}

// Derives the grid anew when the scene calls for it. All objects then move to a new grid in this step, except when it
// is only for the crowd and cells would hardly become smaller: this crowd is then what the scene is like.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::follow_scene() {
  if (fixed_grid()) return;
  const bool must = !gridded_ || outgrown();
  if (!must && !crowded()) return;
  const GridSpec<Scalar, Dim> spec = derive_grid();
  if (!must && spec.cell_size() > 0.75 * grid_.spec().cell_size()) {
    crowding_at_fit_ = crowding_;
    return;
  }
  grid_.reset(spec, config_.cell);
  gridded_ = true;
  regridding_ = true;
  objects_at_fit_ = std::max<std::size_t>(objects_.size(), 32);
  outside_ = 0;
  counters_.regrids = 1;
}

template <class Scalar, int Dim>
GridSpec<Scalar, Dim> EngineCore<Scalar, Dim>::derive_grid() const {
  GridFit<Scalar, Dim> fit;
  fit.population = config_.cell_population;
  fit.cell_size = config_.cell_size;
  fit.bounds = config_.bounds;
  std::vector<BoxType> sample;
  const std::size_t stride = std::max<std::size_t>(1, objects_.size() / GridFit<Scalar, Dim>::kSample);
  std::size_t seen = 0;
  for (ObjectId object = 0; object < objects_.bound(); ++object) {
    const std::uint8_t state = objects_.state(object);
    if (state == 0 || (state & Objects::kErased) != 0) continue;
    if (seen++ % stride == 0) sample.push_back(objects_.record(object).box);
  }
  return fit.derive(sample, objects_.size());
}

// ---- what clients ask for

template <class Scalar, int Dim>
std::vector<PairKey> EngineCore<Scalar, Dim>::pairs() const {
  std::vector<PairKey> pairs;
  for (const Shard& shard : shards_) shard.witnesses.append_pairs(pairs);
  return pairs;
}

template <class Scalar, int Dim>
Stats EngineCore<Scalar, Dim>::stats() const {
  Stats stats;
  stats.step = counters_;
  stats.total = total_;
  stats.steps = steps_;
  for (StageGraph::StageId stage = 0; stage < graph_->size(); ++stage) {
    stats.stages.push_back({graph_->name(stage), idle_ ? 0 : graph_->seconds(stage)});
  }
  stats.objects = objects_.size();
  stats.cell_size = grid_.spec().cell_size();
  if (gridded_) {
    stats.cells = grid_.spec().cell_count();
    for (CellIndex cell = 0; cell < stats.cells; ++cell) stats.occupied_cells += grid_.cell(cell) != nullptr ? 1 : 0;
  }
  stats.bytes_objects = objects_.bytes();
  stats.bytes_cells = grid_.cell_bytes();
  stats.bytes_queues = grid_.queue_bytes();
  for (const DrainTask& task : tasks_) {
    stats.bytes_queues += (task.deltas.capacity() + task.by_shard.capacity()) * sizeof(OverlapDelta);
  }
  for (const Shard& shard : shards_) {
    stats.pairs += shard.witnesses.size();
    stats.bytes_witnesses +=
        shard.witnesses.bytes() + (shard.begins.capacity() + shard.ends.capacity()) * sizeof(PairKey);
  }
  return stats;
}

}  // namespace sweepgrid
