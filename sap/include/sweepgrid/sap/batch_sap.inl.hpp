#pragma once

#include <algorithm>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include <sweepgrid/sap/batch_sap.hpp>
#include <sweepgrid/sap/invariant.hpp>
#include <sweepgrid/sap/prefetch.hpp>

namespace sweepgrid {

namespace batch_sap {
/// Measured (sap/README.md): a local sort wins while fewer than one in this many residents move.
inline constexpr std::size_t kLocalSortShare = 3;
/// Measured: up to this many inserts and erases, tests against all residents beat the sweep sets.
inline constexpr std::size_t kDirectOps = 12;

/// Resizes with an eighth to spare: a vector's own doubling would cost a third of a cell's memory. Places have 32 bits.
template <class T>
void grow(std::vector<T>& values, std::size_t size) {
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    throw std::length_error("sweepgrid: an interval list of more than 2^32 - 1 places");
  }
  if (values.capacity() < size) values.reserve(size + size / 8);
  values.resize(size);
}
}  // namespace batch_sap

template <class Scalar, int Dim>
struct BatchSap<Scalar, Dim>::Integration {
  int axis;
  bool report_erases;   // on the first axis, while all others still speak of the old boxes
  bool report_inserts;  // on the last axis, when all others speak of the new boxes
  SweepSets* sets;      // null when nothing is reported by sweeping
  End* list;
  std::ptrdiff_t from;  // place of the next retained endpoint, in the direction of the pass
  std::ptrdiff_t from_end;
  std::ptrdiff_t to;                      // place to write next
  std::span<const End> inserts;           // in the order of the pass
  std::span<const std::uint32_t> erases;  // places, in the order of the pass
};

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::drain(std::span<const Op> ops, DeltaList& deltas, SapCounters& counters) {
  DrainArena arena(deltas);
  const Ops resolved(ops, slots_, arena.resource());
  Drain drain{deltas, counters, arena.resource()};
  const std::size_t deltas_before = deltas.size();
  if (!resolved.inserts.empty() || !resolved.erases.empty()) {
    integrate(resolved, drain);
  } else if (batch_sap::kLocalSortShare * resolved.updates.size() < size()) {
    local_sort(resolved, drain);
  } else {
    global_sort(resolved, drain);
  }
  counters.deltas += deltas.size() - deltas_before;
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::transfer(std::span<const Op> ops, SapCounters& /*counters*/) {
  DrainArena arena;
  const Ops resolved(ops, slots_, arena.resource());
  batch_sap::grow(ranks_, slots_.slot_bound());
  for (const auto& entry : resolved.erases) ranks_[entry.slot] = kEmptyRanks;
  for (int axis = 0; axis < Dim; ++axis) {
    FloatingList& list = lists_[axis];
    std::vector<End> ends;
    ends.reserve(2 * (size() - resolved.erases.size()));
    for (std::uint32_t place = list.begin; place < list.end; ++place) {
      const Ranks& ranks = ranks_[list.storage[place].owner()];
      if (ranks.min[0] <= ranks.max[0]) ends.push_back(list.storage[place]);
    }
    for (const auto& [slot, op] : resolved.inserts) {
      ends.push_back(End::min_of(slot, op->box.min[axis]));
      ends.push_back(End::max_of(slot, op->box.max[axis]));
    }
    std::sort(ends.begin(), ends.end());
    list.storage = std::move(ends);
    list.begin = 0;
    list.end = static_cast<std::uint32_t>(list.storage.size());
  }
  for (int axis = 0; axis < Dim; ++axis) read_ranks(axis);
  for (const auto& entry : resolved.erases) slots_.release(entry.op->object);
}

// Trailing endpoint first: a box that moves by more than its width is inverted in flight and so overlaps nothing that
// it jumps over, which saves a +1 and a -1 for each.
template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::local_sort(const Ops& ops, Drain& drain) {
  ++drain.counters.local_sorts;
  for (int axis = 0; axis < Dim; ++axis) {
    for (const auto& [slot, op] : ops.updates) {
      const End new_min = End::min_of(slot, op->box.min[axis]);
      const End new_max = End::max_of(slot, op->box.max[axis]);
      const bool rightwards = lists_[axis].storage[ranks_[slot].min[axis]] < new_min;
      move(axis, rightwards ? new_min : new_max, drain);
      move(axis, rightwards ? new_max : new_min, drain);
    }
  }
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::move(int axis, End end, Drain& drain) {
  const std::uint32_t place = rank(axis, end);
  if (end < lists_[axis].storage[place]) {
    move_left(axis, place, end, drain);
  } else {
    move_right(axis, place, end, drain);
  }
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::global_sort(const Ops& ops, Drain& drain) {
  ++drain.counters.global_sorts;
  for (int axis = 0; axis < Dim; ++axis) {
    write_updates(axis, ops);
    sort_in_place(axis, drain);
  }
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::integrate(const Ops& ops, Drain& drain) {
  ++drain.counters.global_sorts;
  batch_sap::grow(ranks_, slots_.slot_bound());
  for (const auto& entry : ops.inserts) ranks_[entry.slot] = kEmptyRanks;
  // On one axis there is no other on which an inserted object could be empty.
  if (Dim > 1 && ops.inserts.size() + ops.erases.size() <= batch_sap::kDirectOps) {
    integrate_few(ops, drain);
  } else {
    SweepSets sets(slots_.slot_bound(), drain.memory);
    for (int axis = 0; axis < Dim; ++axis) {
      write_updates(axis, ops);
      integrate_axis(axis, ops, &sets, drain);
      read_ranks(axis);
    }
  }
  for (const auto& entry : ops.erases) {
    ranks_[entry.slot] = kEmptyRanks;
    slots_.release(entry.op->object);
  }
  for (FloatingList& list : lists_) shrink(list);
}

// For a few ops it is cheaper to test each against all residents than to keep sets while passing over all endpoints.
// Erased objects are tested before anything has moved, inserted ones after everything has; in between they are empty.
template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::integrate_few(const Ops& ops, Drain& drain) {
  std::pmr::vector<Ranks> erased(drain.memory);
  for (const auto& entry : ops.erases) {
    erased.push_back(ranks_[entry.slot]);
    test_against_all(entry.slot, -1, drain);
    ranks_[entry.slot] = kEmptyRanks;  // so that a pair of two erased objects is reported once
  }
  for (std::size_t i = 0; i < erased.size(); ++i) ranks_[ops.erases[i].slot] = erased[i];
  std::pmr::vector<Ranks> inserted(ops.inserts.size(), kEmptyRanks, drain.memory);
  for (int axis = 0; axis < Dim; ++axis) {
    write_updates(axis, ops);
    integrate_axis(axis, ops, nullptr, drain);
    read_ranks(axis);
    for (std::size_t i = 0; i < inserted.size(); ++i) {
      Ranks& ranks = ranks_[ops.inserts[i].slot];
      inserted[i].min[axis] = std::exchange(ranks.min[axis], kEmptyRanks.min[axis]);
      inserted[i].max[axis] = std::exchange(ranks.max[axis], kEmptyRanks.max[axis]);
    }
  }
  for (const auto& entry : ops.erases) ranks_[entry.slot] = kEmptyRanks;
  for (std::size_t i = 0; i < inserted.size(); ++i) {
    ranks_[ops.inserts[i].slot] = inserted[i];
    test_against_all(ops.inserts[i].slot, +1, drain);
  }
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::write_updates(int axis, const Ops& ops) {
  End* list = lists_[axis].storage.data();
  for (const auto& [slot, op] : ops.updates) {
    const Ranks& ranks = ranks_[slot];
    list[ranks.min[axis]] = End::min_of(slot, op->box.min[axis]);
    list[ranks.max[axis]] = End::max_of(slot, op->box.max[axis]);
  }
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::sort_in_place(int axis, Drain& drain) {
  FloatingList& list = lists_[axis];
  drain.counters.endpoints_visited += list.end - list.begin;
  End* const base = list.storage.data();
  for (std::uint32_t place = list.begin + 1; place < list.end; ++place) {
    const End end = base[place];
    std::uint32_t hole = place;
    while (hole > list.begin && end < base[hole - 1]) {
      const End other = base[hole - 1];
      base[hole] = other;
      rank(axis, other) = hole;
      --hole;
      swapped<false>(axis, other, end, drain);
    }
    if (hole != place) {
      base[hole] = end;
      rank(axis, end) = hole;
    }
  }
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::move_right(int axis, std::uint32_t place, End end, Drain& drain) {
  FloatingList& list = lists_[axis];
  End* const base = list.storage.data();
  while (place + 1 < list.end && base[place + 1] < end) {
    const End other = base[place + 1];
    base[place] = other;
    rank(axis, other) = place;
    ++place;
    swapped<true>(axis, end, other, drain);
  }
  base[place] = end;
  rank(axis, end) = place;
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::move_left(int axis, std::uint32_t place, End end, Drain& drain) {
  FloatingList& list = lists_[axis];
  End* const base = list.storage.data();
  while (place > list.begin && end < base[place - 1]) {
    const End other = base[place - 1];
    base[place] = other;
    rank(axis, other) = place;
    --place;
    swapped<true>(axis, other, end, drain);
  }
  base[place] = end;
  rank(axis, end) = place;
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::integrate_axis(int axis, const Ops& ops, SweepSets* sets, Drain& drain) {
  std::pmr::vector<End> inserts(drain.memory);
  inserts.reserve(2 * ops.inserts.size());
  for (const auto& [slot, op] : ops.inserts) {
    inserts.push_back(End::min_of(slot, op->box.min[axis]));
    inserts.push_back(End::max_of(slot, op->box.max[axis]));
  }
  std::sort(inserts.begin(), inserts.end());
  std::pmr::vector<std::uint32_t> erases(drain.memory);
  erases.reserve(2 * ops.erases.size());
  for (const auto& entry : ops.erases) {
    erases.push_back(ranks_[entry.slot].min[axis]);
    erases.push_back(ranks_[entry.slot].max[axis]);
  }
  std::sort(erases.begin(), erases.end());

  FloatingList& list = lists_[axis];
  drain.counters.endpoints_sorted += inserts.size() + erases.size();
  drain.counters.endpoints_visited += list.end - list.begin + inserts.size();
  const auto added = static_cast<std::uint32_t>(inserts.size());
  const auto count = static_cast<std::uint32_t>(list.end - list.begin + added - erases.size());
  const bool forward = list.begin >= added;
  const std::size_t needed = std::size_t{list.end} + added;
  if (!forward && list.storage.size() < needed) batch_sap::grow(list.storage, needed);
  Integration in{axis, sets != nullptr && axis == 0 && !erases.empty(),
                 sets != nullptr && axis == Dim - 1 && !inserts.empty(), sets, list.storage.data(), list.begin,
                 list.end,
                 // With nothing to insert the list stays where it is.
                 added == 0 ? list.begin : 0, inserts, erases};
  if (forward) {
    list.begin = static_cast<std::uint32_t>(in.to);
    list.end = list.begin + count;
    pass<true>(in, drain);
  } else {
    std::reverse(inserts.begin(), inserts.end());
    std::reverse(erases.begin(), erases.end());
    in.from = std::ptrdiff_t{list.end} - 1;
    in.from_end = std::ptrdiff_t{list.begin} - 1;
    list.end = static_cast<std::uint32_t>(list.storage.size());
    list.begin = list.end - count;
    in.to = std::ptrdiff_t{list.end} - 1;
    pass<false>(in, drain);
  }
}

// Table 2 of the paper, in either direction. An object "opens" at the first of its endpoints that the pass meets.
template <class Scalar, int Dim>
template <bool kForward>
void BatchSap<Scalar, Dim>::pass(const Integration& in, Drain& drain) {
  constexpr std::ptrdiff_t kStep = kForward ? 1 : -1;
  constexpr std::ptrdiff_t kNowhere = std::numeric_limits<std::ptrdiff_t>::min();
  const auto before = [](End a, End b) { return kForward ? a < b : b < a; };
  End* const list = in.list;
  std::ptrdiff_t from = in.from;
  std::ptrdiff_t to = in.to;
  auto insert = in.inserts.begin();
  auto erase = in.erases.begin();
  std::ptrdiff_t next_erase = erase == in.erases.end() ? kNowhere : std::ptrdiff_t{*erase};
  while (true) {
    const bool more = from != in.from_end;
    if (more && from == next_erase) {
      if (in.report_erases) {
        sweep<kForward>(in, SweepSets::kErased, list[from], SweepSets::kRetained, SweepSets::kErased, -1, drain);
      }
      from += kStep;
      next_erase = ++erase == in.erases.end() ? kNowhere : std::ptrdiff_t{*erase};
    } else if (insert != in.inserts.end() && (!more || before(*insert, list[from]))) {
      const End end = *insert++;
      if (in.report_inserts) {
        sweep<kForward>(in, SweepSets::kInserted, end, SweepSets::kRetained, SweepSets::kInserted, +1, drain);
      }
      list[to] = end;
      to += kStep;
    } else if (more) {
      const End end = list[from];
      from += kStep;
      if (in.report_erases || in.report_inserts) sweep_retained<kForward>(in, end, drain);
      std::ptrdiff_t hole = to;
      while (hole != in.to && before(end, list[hole - kStep])) {
        const End other = list[hole - kStep];
        list[hole] = other;
        hole -= kStep;
        kForward ? swapped<false>(in.axis, other, end, drain) : swapped<false>(in.axis, end, other, drain);
      }
      list[hole] = end;
      to += kStep;
    } else {
      return;
    }
  }
}

// The sets follow the order in which endpoints are fetched, and in that order the retained list is still the old one;
// what the insertion sort changes after that is reported by swaps.
template <class Scalar, int Dim>
template <bool kForward>
void BatchSap<Scalar, Dim>::sweep(const Integration& in, SweepSets::Set own, End end, SweepSets::Set first,
                                  SweepSets::Set second, std::int32_t change, Drain& drain) {
  if (end.is_max() != kForward) {
    in.sets->add(own, end.owner());
  } else {
    in.sets->remove(own, end.owner());
    test_against(in, first, end.owner(), change, drain);
    test_against(in, second, end.owner(), change, drain);
  }
}

template <class Scalar, int Dim>
template <bool kForward>
void BatchSap<Scalar, Dim>::sweep_retained(const Integration& in, End end, Drain& drain) {
  if (end.is_max() != kForward) {
    in.sets->add(SweepSets::kRetained, end.owner());
  } else {
    in.sets->remove(SweepSets::kRetained, end.owner());
    if (in.report_erases) test_against(in, SweepSets::kErased, end.owner(), -1, drain);
    if (in.report_inserts) test_against(in, SweepSets::kInserted, end.owner(), +1, drain);
  }
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::test_against(const Integration& in, SweepSets::Set set, Slot slot, std::int32_t change,
                                         Drain& drain) {
  for (const Slot other : in.sets->members(set)) {
    ++drain.counters.box_tests;
    if (overlap_beside(in.axis, slot, other)) report(slot, other, change, drain);
  }
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::test_against_all(Slot slot, std::int32_t change, Drain& drain) {
  drain.counters.box_tests += ranks_.size();
  for (Slot other = 0; other < ranks_.size(); ++other) {
    if (overlap_beside(-1, slot, other) && other != slot) report(slot, other, change, drain);
  }
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::read_ranks(int axis) {
  const FloatingList& list = lists_[axis];
  for (std::uint32_t place = list.begin; place < list.end; ++place) rank(axis, list.storage[place]) = place;
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::shrink(FloatingList& list) {
  const std::size_t count = list.end - list.begin;
  if (list.storage.size() <= 4 * count + 64) return;
  const auto axis = static_cast<int>(&list - lists_.data());
  list.storage = std::vector<End>(list.storage.begin() + list.begin, list.storage.begin() + list.end);
  list.begin = 0;
  list.end = static_cast<std::uint32_t>(count);
  read_ranks(axis);
}

template <class Scalar, int Dim>
bool BatchSap<Scalar, Dim>::overlap_beside(int axis, Slot a, Slot b) const {
  const Ranks& x = ranks_[a];
  const Ranks& y = ranks_[b];
  unsigned overlap = 1;
  for (int d = 0; d < Dim; ++d) {
    overlap &= (unsigned{x.min[d] < y.max[d]} & unsigned{y.min[d] < x.max[d]}) | unsigned{d == axis};
  }
  return overlap != 0;
}

template <class Scalar, int Dim>
template <bool kInFlight>
void BatchSap<Scalar, Dim>::swapped(int axis, End left, End right, Drain& drain) {
  ++drain.counters.swaps;
  if (left.is_max() == right.is_max() || left.owner() == right.owner()) return;
  const Slot a = left.owner();
  const Slot b = right.owner();
  // A max on the left means that the intervals were apart and now meet. That holds only if their other ends are in
  // order too, which they always are unless a box is inverted in flight.
  const bool begins = left.is_max();
  if constexpr (kInFlight) {
    const bool others_meet =
        begins ? ranks_[a].min[axis] < ranks_[b].max[axis] : ranks_[b].min[axis] < ranks_[a].max[axis];
    if (!others_meet) return;
  }
  ++drain.counters.box_tests;
  if (overlap_beside(axis, a, b)) report(a, b, begins ? +1 : -1, drain);
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::report(Slot a, Slot b, std::int32_t change, Drain& drain) {
  drain.deltas.push_back({PairKey(slots_.object(a), slots_.object(b)), change});
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::prefetch() const {
  slots_.prefetch();
  sweepgrid::prefetch(ranks_.data(), ranks_.size() * sizeof(Ranks));
  for (const FloatingList& list : lists_) {
    sweepgrid::prefetch(list.storage.data() + list.begin, (list.end - list.begin) * sizeof(End));
  }
}

template <class Scalar, int Dim>
std::size_t BatchSap<Scalar, Dim>::bytes() const {
  std::size_t total = sizeof(*this) + slots_.bytes() + ranks_.capacity() * sizeof(Ranks);
  for (const FloatingList& list : lists_) total += list.storage.capacity() * sizeof(End);
  return total;
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::append_residents(std::vector<Resident>& residents) const {
  for (Slot slot = 0; slot < slots_.slot_bound(); ++slot) {
    if (slots_.object(slot) == kNoObject) continue;
    Resident resident;
    resident.object = slots_.object(slot);
    for (int axis = 0; axis < Dim; ++axis) {
      resident.box.min[axis] = lists_[axis].storage[ranks_[slot].min[axis]].value();
      resident.box.max[axis] = lists_[axis].storage[ranks_[slot].max[axis]].value();
    }
    residents.push_back(resident);
  }
}

template <class Scalar, int Dim>
void BatchSap<Scalar, Dim>::validate() const {
  for (int axis = 0; axis < Dim; ++axis) {
    const FloatingList& list = lists_[axis];
    const auto where = [&] { return "interval list of axis " + std::to_string(axis); };
    for (std::uint32_t place = list.begin + 1; place < list.end; ++place) {
      require_invariant(list.storage[place - 1] < list.storage[place], "S1",
                        [&] { return where() + " is out of order at place " + std::to_string(place); });
    }
    require_invariant(list.end - list.begin == 2 * size(), "S2",
                      [&] { return where() + " does not hold two endpoints per object"; });
    for (Slot slot = 0; slot < slots_.slot_bound(); ++slot) {
      if (slots_.object(slot) == kNoObject) continue;
      const Ranks& ranks = ranks_[slot];
      const auto is_at = [&](std::uint32_t place, bool max) {
        return place >= list.begin && place < list.end && list.storage[place].owner() == slot &&
               list.storage[place].is_max() == max;
      };
      require_invariant(is_at(ranks.min[axis], false) && is_at(ranks.max[axis], true), "S2", [&] {
        return where() + " does not hold object " + std::to_string(slots_.object(slot)) + " at its ranks";
      });
      require_invariant(ranks.min[axis] < ranks.max[axis], "S2", [&] {
        return where() + " holds object " + std::to_string(slots_.object(slot)) + " max before min";
      });
    }
  }
}

}  // namespace sweepgrid
