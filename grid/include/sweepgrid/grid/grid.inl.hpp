#pragma once

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <string>
#include <utility>

#include <sweepgrid/grid/grid.hpp>
#include <sweepgrid/grid/grid_route.inl.hpp>
#include <sweepgrid/sap/invariant.hpp>
#include <sweepgrid/sap/prefetch.hpp>

namespace sweepgrid {

template <class Scalar, int Dim>
Grid<Scalar, Dim>::Grid(const GridSpec<Scalar, Dim>& spec, const CellOptions& options, std::size_t shards)
    : spec_(spec), options_(options), shard_shift_(64 - std::countr_zero(shards)), shards_(shards) {}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::begin_step(std::size_t blocks, StepBudget* budget) {
  ops_.reset(blocks, shards_.size());
  late_.reset(blocks, shards_.size());
  waiting_.resize(blocks);
  budget_ = budget;
}

// ---- gather

template <class Scalar, int Dim>
auto Grid<Scalar, Dim>::make_cell_at(Shard& shard, std::uint64_t code, CellId& place) -> CellId {
  CellId id;
  if (shard.free.empty()) {
    id = static_cast<CellId>(shard.cells.size());
    if (id > OpQueues::kMaxCells) throw std::length_error("sweepgrid: more than 2^29 cells in a part of a grid");
    shard.cells.emplace_back(code, options_);
    shard.queue.push_back(0);
  } else {
    id = shard.free.back();
    shard.cells[id] = CellType(code, options_);
    shard.free.pop_back();
  }
  place = id;
  shard.directory.added(code);
  return id;
}

// The cell of a call that did not exist when the call was queued. Residents make it, visitors only look for it.
template <class Scalar, int Dim>
auto Grid<Scalar, Dim>::locate(Shard& shard, const OpQueues::Fresh& op) -> CellId {
  if (op.call == CellCall::kInsert) {
    CellId& place = shard.directory.place(op.cell);
    return place != CellDirectory<Dim>::kAbsent ? place : make_cell_at(shard, op.cell, place);
  }
  const CellId id = shard.directory.find(op.cell);
  const bool visit = op.call == CellCall::kVisit || op.call == CellCall::kVisitWas || op.call == CellCall::kVisitIs;
  require_invariant(visit || id != CellDirectory<Dim>::kAbsent, "G1",
                    [&] { return "object " + std::to_string(op.object) + " was to be in a cell that is not there"; });
  return id;
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::gather(std::size_t index) {
  Shard& shard = shards_[index];
  shard.active.clear();
  std::size_t total = 0;
  const auto count = [&](CellId id) {
    if (shard.queue[id]++ == 0) shard.active.push_back({id, 0, 0, 0});
    ++total;
  };
  for (OpQueues* queues : {&ops_, &late_}) {
    for (std::size_t block = 0; block < queues->blocks(); ++block) {
      auto& list = queues->list(block, index);
      for (const auto& op : list.known) count(op.cell);
      for (auto& op : list.fresh) {
        const CellId id = locate(shard, op);
        op.cell = id;
        if (id != CellDirectory<Dim>::kAbsent) count(id);
      }
    }
  }
  std::uint32_t first = 0;
  for (ActiveCell& active : shard.active) {
    active.first_call = first;
    active.call_count = shard.queue[active.cell];
    active.population = static_cast<std::uint32_t>(shard.cells[active.cell].size());
    first += active.call_count;
    shard.queue[active.cell] = active.first_call;
  }
  OpQueues::require_countable(total);
  shard.cells_used = shard.directory.size();
  if (total > shard.calls.capacity()) {
    std::vector<Call>().swap(shard.calls);
    shard.calls.reserve(total + total / 8);
  }
  shard.calls.resize(total);
  for (OpQueues* queues : {&ops_, &late_}) {
    for (std::size_t block = 0; block < queues->blocks(); ++block) {
      const auto& list = queues->list(block, index);
      for (const auto& op : list.known) {
        shard.calls[shard.queue[op.cell]++] = {op.object, static_cast<CellCall>(op.call)};
      }
      for (const auto& op : list.fresh) {
        if (op.cell != CellDirectory<Dim>::kAbsent) shard.calls[shard.queue[op.cell]++] = {op.object, op.call};
      }
    }
    queues->note_step(index);
  }
  for (const ActiveCell& active : shard.active) shard.queue[active.cell] = 0;
}

// ---- drain

template <class Scalar, int Dim>
template <class Boxes>
void Grid<Scalar, Dim>::drain(std::size_t index, std::span<const ActiveCell> cells, const Boxes& boxes, Output& out) {
  Shard& shard = shards_[index];
  constexpr std::size_t kAhead = 8;
  const auto announce = [&](const ActiveCell& active) {
    for (std::uint32_t i = 0; i < active.call_count; ++i) boxes.prefetch(shard.calls[active.first_call + i].object);
    sweepgrid::prefetch(&shard.cells[active.cell], sizeof(CellType));
  };
  for (std::size_t i = 0; i < std::min(kAhead, cells.size()); ++i) announce(cells[i]);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i + kAhead < cells.size()) announce(cells[i + kAhead]);
    if (i + 3 < cells.size()) shard.cells[cells[i + 3].cell].prefetch();
    drain_cell(shard, cells[i], boxes, out);
  }
}

template <class Scalar, int Dim>
template <class Boxes>
void Grid<Scalar, Dim>::drain_cell(Shard& shard, const ActiveCell& active, const Boxes& boxes, Output& out) {
  CellType& cell = shard.cells[active.cell];
  const std::size_t before = out.deltas.size();
  const auto calls = std::span<const Call>(shard.calls).subspan(active.first_call, active.call_count);
  out.note_cell(calls.size(), cell.size());
  const std::size_t heard = take_ops(calls, boxes, out);
  if (heard == calls.size()) {
    cell.drain(out.ops, out.deltas, out.counters);
  } else {
    drain_visited(cell, calls.subspan(heard), boxes, out);
  }
  if (out.deltas.size() > before) out.runs.push_back({out.deltas.size(), cell.code()});
  if (cell.size() == 0) out.emptied.push_back(active.cell);
}

// Inserts, updates and erases as ops with boxes; returns how many calls they are. The others follow.
template <class Scalar, int Dim>
template <class Boxes>
std::size_t Grid<Scalar, Dim>::take_ops(std::span<const Call> calls, const Boxes& boxes, Output& out) {
  static_assert(static_cast<int>(CellCall::kInsert) == static_cast<int>(OpKind::kInsert) &&
                static_cast<int>(CellCall::kUpdate) == static_cast<int>(OpKind::kUpdate) &&
                static_cast<int>(CellCall::kErase) == static_cast<int>(OpKind::kErase));
  out.ops.resize(calls.size());
  std::size_t count = 0;
  for (; count < calls.size() && calls[count].call <= CellCall::kErase; ++count) {
    const auto [object, call] = calls[count];
    out.ops[count] = {object, static_cast<OpKind>(call), OrderedBox<Scalar, Dim>(boxes.after(object))};
  }
  out.ops.resize(count);
  return count;
}

// Calls after the ops, with boxes.
template <class Scalar, int Dim>
template <class Boxes>
void Grid<Scalar, Dim>::take_visits(std::span<const Call> calls, const Boxes& boxes, Output& out) {
  using Ordered = OrderedBox<Scalar, Dim>;
  out.visits.clear();
  for (const auto& [object, call] : calls) {
    typename SweepAndPrune<Scalar, Dim>::Visit visit;
    visit.object = object;
    visit.was = call != CellCall::kVisitIs;
    visit.is = call != CellCall::kVisitWas;
    // A side that there is not has the box of the other one, lest anybody read what was never written.
    visit.before = Ordered(visit.was ? boxes.before(object) : boxes.after(object));
    visit.after = visit.is ? Ordered(boxes.after(object)) : visit.before;
    out.visits.push_back(visit);
  }
}

// Visitors meet residents as they were with the box that they had, and residents as they are with the box that they
// have; those that stay both at once, which leaves out pairs that go on.
template <class Scalar, int Dim>
template <class Boxes>
void Grid<Scalar, Dim>::drain_visited(CellType& cell, std::span<const Call> calls, const Boxes& boxes,
                                      Output& out) const {
  take_visits(calls, boxes, out);
  if (out.ops.empty()) return cell.visit(out.visits, out.residents, out.deltas, out.counters);
  if (cell.has_rows()) return refresh_visited(cell, boxes, out);
  cell.visit(sides(out.visits, true, out), out.residents, out.deltas, out.counters);
  cell.drain(out.ops, out.deltas, out.counters);
  cell.visit(sides(out.visits, false, out), out.residents, out.deltas, out.counters);
}

// Who goes is met as it was, who comes as it is; each in rows of its own.
template <class Scalar, int Dim>
template <class Boxes>
void Grid<Scalar, Dim>::refresh_visited(CellType& cell, const Boxes& boxes, Output& out) {
  const auto stays =
      std::partition(out.ops.begin(), out.ops.end(), [](const auto& op) { return op.kind == OpKind::kErase; });
  const auto comes = std::partition(stays, out.ops.end(), [](const auto& op) { return op.kind == OpKind::kUpdate; });
  const std::span<const CellOp<Scalar, Dim>> goers(out.ops.begin(), stays);
  const std::span<const CellOp<Scalar, Dim>> comers(comes, out.ops.end());
  const auto meet = [&](std::span<const CellOp<Scalar, Dim>> ops, bool were) {
    if (ops.empty()) return;
    out.passing.clear();
    for (const auto& op : ops) {
      out.passing.push_back(
          {op.object, OpKind::kInsert, were ? OrderedBox<Scalar, Dim>(boxes.before(op.object)) : op.box});
    }
    out.passing_rows.refill(out.passing);
    out.passing_rows.visit(sides(out.visits, were, out), out.deltas, out.counters);
  };
  meet(goers, true);
  cell.drain(goers, out.deltas, out.counters);
  cell.rows().refresh(boxes, out.refresh, out.deltas, out.counters, out.visits);
  cell.drain(comers, out.deltas, out.counters);
  meet(comers, false);
}

// Visits with one of their sides only, the box that they had or the one that they have.
template <class Scalar, int Dim>
auto Grid<Scalar, Dim>::sides(const Visits& visits, bool were, Output& out) -> const Visits& {
  out.sides.clear();
  for (const auto& visit : visits) {
    if (!(were ? visit.was : visit.is)) continue;
    out.sides.push_back(visit);
    (were ? out.sides.back().is : out.sides.back().was) = false;
  }
  return out.sides;
}

template <class Scalar, int Dim>
template <class BoxOf>
void Grid<Scalar, Dim>::fill(std::size_t index, const BoxOf& box_of, Output& out) {
  gather(index);
  Shard& shard = shards_[index];
  constexpr std::size_t kAhead = 24;
  for (const ActiveCell& active : shard.active) {
    const auto calls = std::span<const Call>(shard.calls).subspan(active.first_call, active.call_count);
    out.ops.clear();
    out.note_cell(calls.size(), 0);
    for (std::size_t i = 0; i < calls.size(); ++i) {
      // Calls of the next cells follow.
      const std::size_t ahead = std::min<std::size_t>(active.first_call + i + kAhead, shard.calls.size() - 1);
      sweepgrid::prefetch(&box_of(shard.calls[ahead].object));
      out.ops.push_back({calls[i].object, OpKind::kInsert, OrderedBox<Scalar, Dim>(box_of(calls[i].object))});
    }
    shard.cells[active.cell].fill(out.ops, out.counters);
  }
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::drop_empty(std::size_t index, std::span<const std::uint32_t> cells) {
  Shard& shard = shards_[index];
  for (const CellId id : cells) {
    if (shard.cells[id].size() != 0) continue;
    shard.directory.erase(shard.cells[id].code());
    shard.cells[id] = CellType(0, options_);
    shard.free.push_back(id);
  }
}

// ---- memory

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::note_step() {
  for (Shard& shard : shards_) {
    shard.most_calls.recycle(shard.calls);
    shard.most_active.recycle(shard.active);
    shard.most_cells.note(std::exchange(shard.cells_used, 0));
    release_cells(shard);
  }
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::pass(std::size_t idle) {
  ops_.pass(idle);
  late_.pass(idle);
  for (Shard& shard : shards_) {
    shard.most_calls.pass(idle);
    shard.most_calls.release(shard.calls);
    shard.most_active.pass(idle);
    shard.most_active.release(shard.active);
    shard.most_cells.pass(idle, shard.directory.size());
    release_cells(shard);
  }
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::release_cells(Shard& shard) noexcept {
  const std::size_t allowed = std::max(shard.most_cells.allowed(), 2 * shard.directory.size());
  if (shard.cells.capacity() <= allowed && shard.queue.capacity() <= allowed && shard.free.capacity() <= allowed)
    return;
  try {
    compact(shard);
  } catch (const std::bad_alloc&) {
    // Then another step tries again.
  }
}

// Gives the cells of a shard the ids that are lowest. Nobody keeps ids from step to step.
template <class Scalar, int Dim>
void Grid<Scalar, Dim>::compact(Shard& shard) {
  const std::size_t count = shard.directory.size();
  std::vector<CellType> cells;
  std::vector<std::uint32_t> queue(count, 0);
  cells.reserve(count);
  shard.directory.for_each_id([&](CellId& id) {
    cells.push_back(std::move(shard.cells[id]));
    id = static_cast<CellId>(cells.size() - 1);
  });
  shard.cells.swap(cells);
  shard.queue.swap(queue);
  std::vector<CellId>().swap(shard.free);
}

// ---- looking at cells

template <class Scalar, int Dim>
template <class Visit>
void Grid<Scalar, Dim>::for_each_cell(Visit&& visit) const {
  for (const Shard& shard : shards_) {
    shard.directory.for_each([&](std::uint64_t code) { visit(shard.cells[shard.directory.find(code)]); });
  }
}

template <class Scalar, int Dim>
auto Grid<Scalar, Dim>::find(std::uint64_t code) const -> const CellType* {
  const Shard& shard = shards_[shard_of(code)];
  const CellId id = shard.directory.find(code);
  return id == CellDirectory<Dim>::kAbsent ? nullptr : &shard.cells[id];
}

template <class Scalar, int Dim>
std::size_t Grid<Scalar, Dim>::cell_count() const {
  std::size_t total = 0;
  for (const Shard& shard : shards_) total += shard.directory.size();
  return total;
}

template <class Scalar, int Dim>
std::size_t Grid<Scalar, Dim>::cell_bytes() const {
  std::size_t total = shards_.capacity() * sizeof(Shard);
  for (const Shard& shard : shards_) {
    total += shard.directory.bytes() + shard.cells.capacity() * sizeof(CellType) +
             (shard.free.capacity() + shard.queue.capacity()) * sizeof(std::uint32_t);
    for (const CellType& cell : shard.cells) total += cell.bytes();
  }
  return total;
}

template <class Scalar, int Dim>
std::size_t Grid<Scalar, Dim>::queue_bytes() const {
  std::size_t total = ops_.bytes() + late_.bytes() + waiting_.capacity() * sizeof(Waiting);
  for (const Shard& shard : shards_) {
    total += shard.calls.capacity() * sizeof(Call) + shard.active.capacity() * sizeof(ActiveCell);
  }
  return total;
}

}  // namespace sweepgrid
