#pragma once

#include <algorithm>

#include <sweepgrid/engine/engine_core.hpp>
#include <sweepgrid/engine/scene_sweep.inl.hpp>

namespace sweepgrid {

// Steps that sweep the whole scene and keep no cells, beside those that go through cells.

template <class Scalar, int Dim>
bool EngineCore<Scalar, Dim>::choose_sweep() {
  if (!SceneSweep<Scalar, Dim>::kPossible || counting() || config_.cell.kind != CellKind::kRows) return false;
  if (config_.step_method != StepMethod::kAuto) return config_.step_method == StepMethod::kSweep;
  return method_.sweep(changes_, objects_.size(), celled_ && gridded_);
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::plan_bin(std::vector<std::uint64_t>& costs) {
  if constexpr (SceneSweep<Scalar, Dim>::kPossible) {
    if (sweeping_) sweep_.plan_bin(workers(), costs);
  }
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::bin(std::size_t block) {
  if constexpr (SceneSweep<Scalar, Dim>::kPossible) sweep_.bin(block, worker());
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::plan_sweep(std::vector<std::uint64_t>& costs) {
  if constexpr (SceneSweep<Scalar, Dim>::kPossible) {
    if (sweeping_) sweep_.plan_sweep(worker(), costs);
  }
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::sweep(std::size_t part) {
  if constexpr (SceneSweep<Scalar, Dim>::kPossible) sweep_.sweep(part, worker());
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
