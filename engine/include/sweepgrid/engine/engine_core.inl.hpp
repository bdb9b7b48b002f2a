#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <sweepgrid/engine/drain.inl.hpp>
#include <sweepgrid/engine/engine_core.hpp>
#include <sweepgrid/engine/envelope_filter.inl.hpp>
#include <sweepgrid/engine/envelopes.inl.hpp>
#include <sweepgrid/engine/follow_scene.inl.hpp>
#include <sweepgrid/engine/route.inl.hpp>
#include <sweepgrid/engine/scene_sweep.inl.hpp>
#include <sweepgrid/engine/sweep.inl.hpp>
#include <sweepgrid/engine/take_back.inl.hpp>
#include <sweepgrid/engine/validate.inl.hpp>
#include <sweepgrid/grid/grid_fit.inl.hpp>
#include <sweepgrid/grid/levels.inl.hpp>
#include <sweepgrid/sap/cell_kind.inl.hpp>

namespace sweepgrid {

namespace engine_core {

template <class Scalar, int Dim>
void require_valid(const Config& config) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("sweepgrid: Config::" + what); };
  if (config.cell_population && *config.cell_population < 1) {
    refuse("cell_population is " + std::to_string(*config.cell_population) + ", but must be at least 1");
  }
  if (config.cell_size && !(*config.cell_size > 0 && std::isfinite(*config.cell_size))) {
    refuse("cell_size is " + std::to_string(*config.cell_size) + ", but must be positive and finite");
  }
  if (config.parallel_from < 0) {
    refuse("parallel_from is " + std::to_string(config.parallel_from) + ", but must not be negative");
  }
  if (config.threads < 0) refuse("threads is " + std::to_string(config.threads) + ", but must not be negative");
  static_cast<void>(make_cell<Scalar, Dim>(config.cell));  // refuses bad cell options
}

}  // namespace engine_core

template <class Scalar, int Dim>
EngineCore<Scalar, Dim>::EngineCore(Config config, std::size_t event_bytes)
    : config_(std::move(config)), event_bytes_(event_bytes), sweep_(objects_, budget_, event_bytes) {
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
  // A step either sweeps or goes through cells; the stages of the other way have no tasks.
  const auto binned = stage("bin", {}, &EngineCore::plan_bin, &EngineCore::bin);
  const auto swept = stage("sweep", {binned}, &EngineCore::plan_sweep, &EngineCore::sweep);
  const auto routed = stage("route", {swept}, &EngineCore::plan_route, &EngineCore::route);
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
  if (!run_step()) return false;
  commit_step();
  return true;
}

template <class Scalar, int Dim>
bool EngineCore<Scalar, Dim>::run_step() {
  counters_ = StepCounters{};
  regridding_ = false;
  idle_ = !objects_.anything_queued();
  if (idle_) {
    pass_idle_step();
  } else {
    budget_.start(config_.step_bytes.value_or(StepBudget::kUnlimited));
    try {
      prepare_step();
      graph_->run(alone_);
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
  return true;
}

// What is known before the stages: which way the step goes, and who is to do it.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::prepare_step() {
  pass_idle_steps();
  marked_.restart();
  objects_.for_each_marked([&](std::uint32_t granule) { marked_.items.push_back(granule); });
  changes_ = estimated_changes();
  sweeping_ = choose_sweep();
  alone_ = executor_->concurrency() > 1 && little_to_do();
}

// Judged by every 16th of the granules with a mark; in the others nothing has changed.
template <class Scalar, int Dim>
std::size_t EngineCore<Scalar, Dim>::estimated_changes() const {
  const std::vector<std::uint32_t>& marked = marked_.items;
  std::size_t seen = 0;
  std::size_t changed = 0;
  for (std::size_t i = 0; i < marked.size(); i += 16) {
    const ObjectId first = marked[i] * Objects::kGranule;
    const ObjectId end = std::min(objects_.bound() - first, Objects::kGranule) + first;
    for (ObjectId object = first; object < end; ++object) {
      changed += (objects_.state(object) & Objects::kQueued) != 0 ? 1 : 0;
    }
    ++seen;
  }
  return seen == 0 ? 0 : changed * marked.size() / seen;
}

template <class Scalar, int Dim>
bool EngineCore<Scalar, Dim>::little_to_do() const {
  const auto much = static_cast<std::size_t>(config_.parallel_from);
  if (sweeping_) return objects_.size() < 4 * much;
  return celled_ && changes_ < much;
}

// Of the step that runs.
template <class Scalar, int Dim>
std::size_t EngineCore<Scalar, Dim>::workers() const {
  return alone_ ? 1 : static_cast<std::size_t>(executor_->concurrency());
}
template <class Scalar, int Dim>
std::size_t EngineCore<Scalar, Dim>::worker() const {
  return alone_ ? 0 : static_cast<std::size_t>(executor_->worker());
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::cancel_step() noexcept {
  if (!idle_) take_back_step();
}

// ---- after the stages

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::finish_step() {
  if (sweeping_) return finish_sweep();
  std::size_t retired = 0;
  for (const RouteBlock& block : blocks_) retired += block.retired.items.size();
  objects_.reserve_free(retired);
  for (const DrainTask& task : tasks_) {
    counters_.cells += task.out.counters;
    levels_.grid(task.grid).drop_empty(task.shard, task.out.emptied);
  }
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::commit_step() noexcept {
  ++steps_;
  if (idle_) return;
  if (sweeping_) return commit_sweep();
  for (RouteBlock& block : blocks_) {
    counters_ += block.counters;
    objects_.free_ids(block.retired.items);
    block.note_step();
    block.restart();  // lest a step that fails before it routes frees ids again
  }
  method_.note_cells(counters_);
  if (levels_.live().size() > 1) objects_.set_widest(std::min(objects_.widest(), levels_.drop_empty()));
  marked_.note_step();
  blocks_.finish();
  gathers_.finish();
  tasks_.finish();
  for (const GridIndex grid : levels_.live()) levels_.grid(grid).note_step();
  pass_sweep(1);
}

// An idle step takes next to no time, so lists are told of idle steps only now and then.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::pass_idle_step() {
  constexpr std::size_t kIdleSteps = 8;  // a part of HighWater::kSteps
  tasks_.restart();
  if constexpr (SceneSweep<Scalar, Dim>::kPossible) sweep_.rest();
  for (Shard& shard : shards_) shard.restart();
  if (++idle_steps_ == kIdleSteps) pass_idle_steps();
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::pass_idle_steps() {
  if (idle_steps_ == 0) return;
  const std::size_t steps = std::exchange(idle_steps_, 0);
  marked_.pass(steps);
  blocks_.pass(steps);
  gathers_.pass(steps);
  tasks_.pass(steps);
  pass_sweep(steps);
  for (Shard& shard : shards_) shard.pass(steps);
  for (const GridIndex grid : levels_.live()) levels_.grid(grid).pass(steps);
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
  if (!celled_) return swept_pairs();
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
  stats.cell_size = levels_.live().empty() ? 0 : levels_.cell_size();
  stats.grids = levels_.live().size();
  stats.bytes_cells = levels_.bytes();
  for (const GridIndex index : levels_.live()) {
    const GridType& grid = levels_.grid(index);
    stats.cells += grid.cell_count();
    stats.bytes_cells += grid.cell_bytes();
    stats.bytes_queues += grid.queue_bytes();
  }
  stats.bytes_objects = objects_.bytes();
  stats.bytes_queues +=
      marked_.bytes() + blocks_.bytes() + gathers_.bytes() + tasks_.bytes() + graph_->bytes() + sweep_.bytes();
  stats.bytes_witnesses += shards_.capacity() * sizeof(Shard);
  for (const Shard& shard : shards_) stats.bytes_witnesses += shard.bytes();
  return stats;
}

}  // namespace sweepgrid
