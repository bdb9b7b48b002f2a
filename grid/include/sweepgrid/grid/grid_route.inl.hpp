#pragma once

#include <array>
#include <cstdint>
#include <tuple>

#include <sweepgrid/grid/grid.hpp>
#include <sweepgrid/sap/prefetch.hpp>

namespace sweepgrid {

template <class Scalar, int Dim>
inline void Grid<Scalar, Dim>::call(std::size_t block, std::uint64_t code, ObjectId object, CellCall call) {
  Waiting& waiting = waiting_[block];
  waiting.calls[waiting.count++] = {code, object, call};
  if (waiting.count >= Waiting::kMost) look_up(block);
}

template <class Scalar, int Dim>
inline void Grid<Scalar, Dim>::call_all(std::size_t block, const Range& range, ObjectId object, CellCall what) {
  if constexpr (Waiting::kCorners > 1) {
    if (range.few()) [[likely]] {
      Waiting& waiting = waiting_[block];
      std::size_t count = waiting.count;
      range.for_each_corner([&](std::uint64_t code, bool fresh) {
        waiting.calls[count] = {code, object, what};
        count += fresh ? 1 : 0;
      });
      waiting.count = count;
      if (count >= Waiting::kMost) look_up(block);
      return;
    }
  }
  range.for_each([&](std::uint64_t cell) { call(block, cell, object, what); });
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::look_up(std::size_t block) {
  Waiting& waiting = waiting_[block];
  if (budget_ != nullptr) budget_->charge(waiting.count * kCallBytes);
  static constexpr CellId kNowhere = CellDirectory<Dim>::kAbsent;
  std::array<const CellId*, std::tuple_size_v<decltype(waiting.calls)>> places;
  for (std::size_t i = 0; i < waiting.count; ++i) {
    const std::uint64_t code = waiting.calls[i].cell;
    const CellId* const cells = shards_[shard_of(code)].directory.find_block(Code::block(code));
    places[i] = cells == nullptr ? &kNowhere : cells + Code::inner(code);
    sweepgrid::prefetch(places[i]);
  }
  for (std::size_t i = 0; i < waiting.count; ++i) {
    const OpQueues::Fresh& call = waiting.calls[i];
    auto& list = (call.call <= CellCall::kErase ? ops_ : late_).list(block, shard_of(call.cell));
    if (const CellId id = *places[i]; id != CellDirectory<Dim>::kAbsent) {
      list.known.push_back({id, static_cast<std::uint32_t>(call.call), call.object});
    } else {
      list.fresh.push_back(call);
    }
  }
  waiting.count = 0;
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::route_insert(std::size_t block, ObjectId object, const BoxType& box) {
  call_all(block, spec_.range(box), object, CellCall::kInsert);
}

template <class Scalar, int Dim>
bool Grid<Scalar, Dim>::route_update(std::size_t block, ObjectId object, const BoxType& before, const BoxType& after) {
  const Range range = spec_.range(after);
  const Range old_range = spec_.range(before);
  if (range == old_range) [[likely]] {
    call_all(block, range, object, CellCall::kUpdate);
    return false;
  }
  range.for_each([&](std::uint64_t cell) {
    const bool known = old_range.contains(Code::coordinates(cell));
    call(block, cell, object, known ? CellCall::kUpdate : CellCall::kInsert);
  });
  old_range.for_each([&](std::uint64_t cell) {
    if (!range.contains(Code::coordinates(cell))) call(block, cell, object, CellCall::kErase);
  });
  return true;
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::route_erase(std::size_t block, ObjectId object, const BoxType& before) {
  call_all(block, spec_.range(before), object, CellCall::kErase);
}

template <class Scalar, int Dim>
void Grid<Scalar, Dim>::route_visit(std::size_t block, ObjectId object, const BoxType* before, const BoxType* after,
                                    bool resting_only) {
  const Range was = spec_.range(before != nullptr ? *before : *after);
  const Range is = spec_.range(after != nullptr ? *after : *before);
  const CellCall what = before == nullptr  ? CellCall::kVisitIs
                        : after == nullptr ? CellCall::kVisitWas
                                           : CellCall::kVisit;
  const bool skip_covered = resting_only && what == CellCall::kVisit;
  const auto concerns = [&](const CellCoordinates<Dim>& cell) {
    return !(skip_covered && was.surrounds(cell) && is.surrounds(cell));
  };
  // A huge box has more cells than exist.
  if (resting_only && is.count() + was.count() > 64 && is.count() + was.count() > static_cast<double>(cell_count())) {
    for (const Shard& shard : shards_) {
      shard.directory.for_each([&](std::uint64_t code) {
        const auto cell = Code::coordinates(code);
        if ((is.contains(cell) || was.contains(cell)) && concerns(cell)) call(block, code, object, what);
      });
    }
    return;
  }
  is.for_each([&](std::uint64_t code) {
    if (!skip_covered || concerns(Code::coordinates(code))) call(block, code, object, what);
  });
  if (was == is) return;
  was.for_each([&](std::uint64_t code) {
    const auto cell = Code::coordinates(code);
    if (!is.contains(cell) && concerns(cell)) call(block, code, object, what);
  });
}

}  // namespace sweepgrid
