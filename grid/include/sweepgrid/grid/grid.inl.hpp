#pragma once

#include <algorithm>
#include <array>
#include <utility>

#include <sweepgrid/grid/grid.hpp>
#include <sweepgrid/sap/prefetch.hpp>

namespace sweepgrid {

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::reset(const GridSpec<Scalar, Dim>& spec, const CellOptions& options) {
  spec_ = spec;
  options_ = options;
  cells_.clear();
  cells_.resize(spec.cell_count());
  cells_.shrink_to_fit();
  queue_.assign(spec.cell_count(), 0);
  queue_.shrink_to_fit();
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::begin_step(std::size_t blocks, std::size_t groups) {
  queues_.reset(blocks, groups);
  groups_.resize(groups);
}

template <class Scalar, int Dim>
template <class Visit>
void Grid<Scalar, Dim>::for_each_cell(const CellRange<Dim>& range, Visit&& visit) const {
  std::array<std::uint16_t, static_cast<std::size_t>(Dim)> cell = range.first;
  while (true) {
    visit(cell);
    int axis = 0;
    for (; axis < Dim && cell[axis] == range.last[axis]; ++axis) cell[axis] = range.first[axis];
    if (axis == Dim) return;
    ++cell[axis];
  }
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::route_insert(std::size_t block, ObjectId object, const BoxType& box, CellRange<Dim>& range) {
  range = spec_.range(box);
  const Op op{object, OpKind::kInsert, OrderedBox<Scalar, Dim>(box)};
  for_each_cell(range, [&](const auto& cell) { queues_.push(block, spec_.index(cell), op); });
}

template <class Scalar, int Dim>
bool Grid<Scalar, Dim>::route_update(std::size_t block, ObjectId object, const BoxType& box, CellRange<Dim>& range) {
  const CellRange<Dim> old_range = range;
  range = spec_.range(box);
  Op op{object, OpKind::kUpdate, OrderedBox<Scalar, Dim>(box)};
  if (range == old_range) {
    for_each_cell(range, [&](const auto& cell) { queues_.push(block, spec_.index(cell), op); });
    return false;
  }
  for_each_cell(range, [&](const auto& cell) {
    op.kind = old_range.contains(cell) ? OpKind::kUpdate : OpKind::kInsert;
    queues_.push(block, spec_.index(cell), op);
  });
  op.kind = OpKind::kErase;
  for_each_cell(old_range, [&](const auto& cell) {
    if (!range.contains(cell)) queues_.push(block, spec_.index(cell), op);
  });
  return true;
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::route_erase(std::size_t block, ObjectId object, const CellRange<Dim>& range) {
  Op op;
  op.object = object;
  op.kind = OpKind::kErase;
  op.box = OrderedBox<Scalar, Dim>{};
  for_each_cell(range, [&](const auto& cell) { queues_.push(block, spec_.index(cell), op); });
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::gather(std::size_t group) {
  Group& out = groups_[group];
  out.active.clear();
  std::size_t total = 0;
  for (std::size_t block = 0; block < queues_.blocks(); ++block) {
    for (const auto& routed : queues_.list(block, group)) {
      if (queue_[routed.cell]++ == 0) out.active.push_back({routed.cell, 0, 0, 0});
    }
    total += queues_.list(block, group).size();
  }
  std::sort(out.active.begin(), out.active.end(),
            [](const ActiveCell& a, const ActiveCell& b) { return a.cell < b.cell; });
  std::uint32_t first = 0;
  for (ActiveCell& active : out.active) {
    active.first_op = first;
    active.op_count = queue_[active.cell];
    active.population = cells_[active.cell] ? static_cast<std::uint32_t>(cells_[active.cell]->size()) : 0;
    first += active.op_count;
    queue_[active.cell] = active.first_op;
  }
  if (total > out.ops.capacity() || 2 * total < out.ops.capacity()) {
    std::vector<Op>().swap(out.ops);
    out.ops.reserve(total + total / 8);
  }
  out.ops.resize(total);
  for (std::size_t block = 0; block < queues_.blocks(); ++block) {
    for (const auto& routed : queues_.list(block, group)) out.ops[queue_[routed.cell]++] = routed.op;
  }
  for (const ActiveCell& active : out.active) queue_[active.cell] = 0;
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::drain(std::size_t group, const ActiveCell& active, std::vector<OverlapDelta>& deltas,
                              SapCounters& counters) {
  auto& cell = cells_[active.cell];
  if (!cell) cell = make_cell<Scalar, Dim>(options_);
  cell->drain(std::span<const Op>(groups_[group].ops).subspan(active.first_op, active.op_count), deltas, counters);
  if (cell->size() == 0) cell.reset();
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::prefetch(const ActiveCell& active, const ActiveCell& next) const {
  if (const auto* cell = cells_[active.cell].get()) cell->prefetch();
  // Where a cell's arrays lie is written in the cell itself, so that comes first.
  sweepgrid::prefetch(cells_[next.cell].get(), 256);
}

template <class Scalar, int Dim>
std::size_t Grid<Scalar, Dim>::cell_bytes() const {
  std::size_t total = cells_.capacity() * sizeof(cells_[0]) + queue_.capacity() * sizeof(queue_[0]);
  for (const auto& cell : cells_) total += cell ? cell->bytes() : 0;
  return total;
}

template <class Scalar, int Dim>
std::size_t Grid<Scalar, Dim>::queue_bytes() const {
  std::size_t total = queues_.bytes() + groups_.capacity() * sizeof(Group);
  for (const Group& group : groups_) {
    total += group.ops.capacity() * sizeof(Op) + group.active.capacity() * sizeof(ActiveCell);
  }
  return total;
}

}  // namespace sweepgrid
