#pragma once

#include <algorithm>

#include <sweepgrid/engine/engine_core.hpp>
#include <sweepgrid/engine/scene_sweep.inl.hpp>

namespace sweepgrid {

// Steps that sweep the whole scene and keep no cells, beside those that go through cells.

template <class Scalar, int Dim>
bool EngineCore<Scalar, Dim>::choose_sweep() {
  const bool rows = config_.cell.kind == CellKind::kRows || config_.cell.kind == CellKind::kAuto;
  if (!SceneSweep<Scalar, Dim>::kPossible || counting() || !rows) return false;
  if (config_.step_method != StepMethod::kAuto) return config_.step_method == StepMethod::kSweep;
  return method_.sweep(estimated_changes(), objects_.size(), celled_ && gridded_);
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::list_marked() {
  marked_.restart();
  for (std::uint32_t granule = 0; granule < objects_.granules(); ++granule) {
    if (objects_.granule_marked(granule)) marked_.items.push_back(granule);
  }
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
void EngineCore<Scalar, Dim>::plan_bin(std::vector<std::uint64_t>& costs) {
  pass_idle_steps();
  list_marked();
  sweeping_ = choose_sweep();
  if constexpr (SceneSweep<Scalar, Dim>::kPossible) {
    if (sweeping_) sweep_.plan_bin(static_cast<std::size_t>(executor_->concurrency()), costs);
  }
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::bin(std::size_t block) {
  if constexpr (SceneSweep<Scalar, Dim>::kPossible) sweep_.bin(block, static_cast<std::size_t>(executor_->worker()));
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::plan_sweep(std::vector<std::uint64_t>& costs) {
  if constexpr (SceneSweep<Scalar, Dim>::kPossible) {
    if (sweeping_) sweep_.plan_sweep(static_cast<std::size_t>(executor_->worker()), costs);
  }
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::sweep(std::size_t part) {
  if constexpr (SceneSweep<Scalar, Dim>::kPossible) sweep_.sweep(part, static_cast<std::size_t>(executor_->worker()));
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::finish_sweep() {
  if constexpr (SceneSweep<Scalar, Dim>::kPossible) sweep_.reserve();
}

// From now on there are no cells, until a step wants some.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::commit_sweep() noexcept {
  if constexpr (SceneSweep<Scalar, Dim>::kPossible) counters_ = sweep_.commit();
  counters_.sweeps = 1;
  method_.note_sweep(objects_.size(), counters_.cell_ops, counters_.cells.box_tests / 2);
  levels_.clear();
  celled_ = gridded_ = false;
  marked_.note_step();
  blocks_.pass(1);
  gathers_.pass(1);
  tasks_.pass(1);
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::pass_sweep(std::size_t steps) {
  if constexpr (SceneSweep<Scalar, Dim>::kPossible) sweep_.pass(steps);
}

}  // namespace sweepgrid
