#pragma once

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <string>
#include <utility>

#include <sweepgrid/grid/grid.hpp>
#include <sweepgrid/sap/invariant.hpp>
#include <sweepgrid/sap/prefetch.hpp>

namespace sweepgrid {

template <class Scalar, int Dim>
Grid<Scalar, Dim>::Grid(const GridSpec<Scalar, Dim>& spec, const CellOptions& options, std::size_t shards)
    : spec_(spec), options_(options), shard_shift_(64 - std::countr_zero(shards)), shards_(shards) {}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::begin_step(std::size_t blocks, bool dense) {
  ops_.reset(blocks, shards_.size());
  late_.reset(blocks, shards_.size());
  dense_ = dense;
}

// ---- route

template <class Scalar, int Dim>
inline void Grid<Scalar, Dim>::push(OpQueues& queues, BlockView& view, std::size_t block, std::uint64_t code,
                                    ObjectId object, CellCall call) {
  if (const std::uint64_t name = Code::block(code); name != view.name) {
    view.name = name;
    view.shard = shard_of(code);
    view.cells = shards_[view.shard].directory.find_block(name);
  }
  const CellId id = view.cells == nullptr ? CellDirectory<Dim>::kAbsent : view.cells[Code::inner(code)];
  auto& list = queues.list(block, view.shard);
  if (id != CellDirectory<Dim>::kAbsent) {
    list.known.push_back({id, static_cast<std::uint32_t>(call), object});
  } else {
    list.fresh.push_back({code, object, call});
  }
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::route_insert(std::size_t block, ObjectId object, const BoxType& box) {
  BlockView view;
  spec_.range(box).for_each([&](std::uint64_t cell) { push(ops_, view, block, cell, object, CellCall::kInsert); });
}

template <class Scalar, int Dim>
bool Grid<Scalar, Dim>::route_update(std::size_t block, ObjectId object, const BoxType& before, const BoxType& after) {
  const Range range = spec_.range(after);
  const Range old_range = spec_.range(before);
  BlockView view;
  if (range == old_range) {
    if (dense_) return false;
    range.for_each([&](std::uint64_t cell) { push(ops_, view, block, cell, object, CellCall::kUpdate); });
    return false;
  }
  range.for_each([&](std::uint64_t cell) {
    const bool known = old_range.contains(Code::coordinates(cell));
    if (known && dense_) return;
    push(ops_, view, block, cell, object, known ? CellCall::kUpdate : CellCall::kInsert);
  });
  old_range.for_each([&](std::uint64_t cell) {
    if (!range.contains(Code::coordinates(cell))) push(ops_, view, block, cell, object, CellCall::kErase);
  });
  return true;
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::route_erase(std::size_t block, ObjectId object, const BoxType& before) {
  BlockView view;
  spec_.range(before).for_each([&](std::uint64_t cell) { push(ops_, view, block, cell, object, CellCall::kErase); });
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::route_attach(std::size_t block, ObjectId object, const BoxType& box) {
  BlockView view;
  spec_.range(box).for_each([&](std::uint64_t cell) { push(late_, view, block, cell, object, CellCall::kAttach); });
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::route_detach(std::size_t block, ObjectId object, const BoxType& box) {
  BlockView view;
  spec_.range(box).for_each([&](std::uint64_t cell) { push(late_, view, block, cell, object, CellCall::kDetach); });
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::route_visit(std::size_t block, ObjectId object, const BoxType* before, const BoxType* after,
                                    bool resting_only) {
  const Range was = spec_.range(before != nullptr ? *before : *after);
  const Range is = spec_.range(after != nullptr ? *after : *before);
  const CellCall call = before == nullptr  ? CellCall::kVisitIs
                        : after == nullptr ? CellCall::kVisitWas
                                           : CellCall::kVisit;
  const bool skip_covered = resting_only && call == CellCall::kVisit;
  const auto concerns = [&](const CellCoordinates<Dim>& cell) {
    return !(skip_covered && was.surrounds(cell) && is.surrounds(cell));
  };
  BlockView view;
  // A huge box has more cells than exist.
  if (resting_only && is.count() + was.count() > 64 && is.count() + was.count() > static_cast<double>(cell_count())) {
    for (const Shard& shard : shards_) {
      shard.directory.for_each([&](std::uint64_t code) {
        const auto cell = Code::coordinates(code);
        if ((is.contains(cell) || was.contains(cell)) && concerns(cell)) push(late_, view, block, code, object, call);
      });
    }
    return;
  }
  is.for_each([&](std::uint64_t code) {
    if (!skip_covered || concerns(Code::coordinates(code))) push(late_, view, block, code, object, call);
  });
  if (was == is) return;
  was.for_each([&](std::uint64_t code) {
    const auto cell = Code::coordinates(code);
    if (!is.contains(cell) && concerns(cell)) push(late_, view, block, code, object, call);
  });
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
  if (op.call == CellCall::kInsert || op.call == CellCall::kAttach) {
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
    if (shard.queue[id]++ == 0 && !dense_) shard.active.push_back({id, 0, 0, 0});
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
  if (dense_) {
    for (CellId id = 0; id < shard.cells.size(); ++id) {
      if (shard.queue[id] != 0 || shard.cells[id].size() != 0) shard.active.push_back({id, 0, 0, 0});
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
  if (total > shard.calls.capacity() || 2 * total < shard.calls.capacity()) {
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
  const bool judged = options_.kind == CellKind::kAuto && cell.size() >= KindChoice::kManyObjects / 2;
  const SapCounters counters_before = judged ? out.counters : SapCounters{};
  const auto calls = std::span<const Call>(shard.calls).subspan(active.first_call, active.call_count);
  if (sort_out(cell, calls, boxes, out)) {
    cell.drain(out.ops, out.deltas, out.counters);
  } else {
    drain_visited(cell, out);
  }
  if (judged) cell.choose_kind(out.ops.size(), out.counters - counters_before, options_, out.counters);
  if (out.deltas.size() > before) out.runs.push_back({out.deltas.size(), cell.code()});
  if (cell.size() == 0) out.emptied.push_back(active.cell);
}

// Turns calls into ops and visits with boxes; returns whether there are but ops.
template <class Scalar, int Dim>
template <class Boxes>
bool Grid<Scalar, Dim>::sort_out(const CellType& cell, std::span<const Call> calls, const Boxes& boxes,
                                 Output& out) const {
  using Ordered = OrderedBox<Scalar, Dim>;
  out.ops.clear();
  std::size_t i = 0;
  for (; i < calls.size() && calls[i].call <= CellCall::kErase; ++i) {
    const auto [object, call] = calls[i];
    out.ops.push_back({object,
                       call == CellCall::kInsert   ? OpKind::kInsert
                       : call == CellCall::kUpdate ? OpKind::kUpdate
                                                   : OpKind::kErase,
                       Ordered(boxes.after(object))});
  }
  if (dense_) {
    const std::size_t called = out.ops.size();
    const auto is_called = [&](ObjectId object) {
      for (std::size_t k = 0; k < called; ++k) {
        if (out.ops[k].object == object) return true;
      }
      return false;
    };
    std::span<const ObjectId> residents = cell.row_ids();
    if (!cell.has_rows()) {
      out.residents.clear();
      cell.kind().append_residents(out.residents);
      out.resident_ids.clear();
      for (const auto& resident : out.residents) out.resident_ids.push_back(resident.object);
      residents = out.resident_ids;
    }
    for (const ObjectId object : residents) {
      if (!boxes.changed(object) || (called != 0 && is_called(object))) continue;
      out.ops.push_back({object, OpKind::kUpdate, Ordered(boxes.after(object))});
    }
  }
  if (i == calls.size()) return true;
  out.visits.clear();
  out.late_visits.clear();
  out.transfers.clear();
  for (; i < calls.size(); ++i) {
    const auto [object, call] = calls[i];
    if (call >= CellCall::kAttach) {
      out.transfers.push_back(
          {object, call == CellCall::kAttach ? OpKind::kInsert : OpKind::kErase, Ordered(boxes.after(object))});
      continue;
    }
    typename SweepAndPrune<Scalar, Dim>::Visit visit;
    visit.object = object;
    visit.was = call != CellCall::kVisitIs;
    visit.is = call != CellCall::kVisitWas;
    if (visit.was) visit.before = Ordered(boxes.before(object));
    if (visit.is) visit.after = Ordered(boxes.after(object));
    out.visits.push_back(visit);
  }
  return false;
}

// Visitors meet residents as they were with the box that they had, and residents as they are with the box that they
// have. Where residents rest, both at once, which leaves out pairs that go on.
template <class Scalar, int Dim>
void Grid<Scalar, Dim>::drain_visited(CellType& cell, Output& out) {
  auto& kind = cell.kind();
  if (out.ops.empty()) {
    kind.visit(out.visits, out.deltas, out.counters);
  } else {
    for (auto& visit : out.visits) {
      if (!visit.is) continue;
      out.late_visits.push_back(visit);
      out.late_visits.back().was = false;
      visit.is = false;
    }
    std::erase_if(out.visits, [](const auto& visit) { return !visit.was; });
    kind.visit(out.visits, out.deltas, out.counters);
    kind.drain(out.ops, out.deltas, out.counters);
    kind.visit(out.late_visits, out.deltas, out.counters);
  }
  if (!out.transfers.empty()) kind.transfer(out.transfers, out.counters);
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
  if (shard.directory.size() == 0) {
    std::vector<CellType>().swap(shard.cells);
    std::vector<std::uint32_t>().swap(shard.queue);
    std::vector<CellId>().swap(shard.free);
  }
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
  std::size_t total = ops_.bytes() + late_.bytes();
  for (const Shard& shard : shards_) {
    total += shard.calls.capacity() * sizeof(Call) + shard.active.capacity() * sizeof(ActiveCell);
  }
  return total;
}

}  // namespace sweepgrid
