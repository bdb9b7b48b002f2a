#pragma once

#include <algorithm>
#include <memory_resource>
#include <span>
#include <vector>

#include <sweepgrid/sap/segmented_sap.hpp>

namespace sweepgrid {

namespace segmented_sap {
/// Measured (sap/README.md): from this many inserts, or erases, in a drain on, they are sorted first.
inline constexpr std::size_t kPresortedOps = 2;
}  // namespace segmented_sap

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::erase(const typename Ops::Entries& entries, Drain& drain) {
  const bool many = integration_ == Integration::kAuto && entries.size() >= segmented_sap::kPresortedOps;
  if (many || integration_ == Integration::kPresorted) {
    erase_presorted(entries, drain);
  } else {
    for (const auto& entry : entries) erase_one(entry.slot, drain);
  }
  for (const auto& entry : entries) slots_.release(entry.op->object);
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::insert(const typename Ops::Entries& entries, Drain& drain) {
  for (const auto& [slot, op] : entries) resting_[slot].box = op->box;
  const bool many = integration_ == Integration::kAuto && entries.size() >= segmented_sap::kPresortedOps;
  if (many || integration_ == Integration::kPresorted) {
    insert_presorted(entries, drain);
  } else {
    for (const auto& entry : entries) insert_one(entry.slot, drain);
  }
}

// ---- one by one

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::erase_one(Slot slot, Drain& drain) {
  report_overlaps(slot, -1, drain);
  for (int axis = 0; axis < Dim; ++axis) {
    const End ends[] = {min_of(axis, slot), max_of(axis, slot)};
    integrate_erases(axis, ends, drain);
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::insert_one(Slot slot, Drain& drain) {
  drain.turns[slot] = kNow;
  for (int axis = 0; axis < Dim; ++axis) {
    const End ends[] = {min_of(axis, slot), max_of(axis, slot)};
    integrate_inserts(axis, ends, drain);
  }
  drain.turns[slot] = 0;
  report_overlaps(slot, +1, drain);
}

// ---- presorted

// All pairs are said before anything is taken out; a pair of two erased objects by the first of them.
template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::erase_presorted(const typename Ops::Entries& entries, Drain& drain) {
  for (int axis = 0; axis < Dim; ++axis) {
    const std::pmr::vector<End> gone = sorted_endpoints(axis, entries, drain);
    if (axis == 0) {
      for (const End end : gone) {
        if (end.is_max()) continue;
        report_overlaps(end.owner(), -1, drain);
        drain.turns[end.owner()] = kReported;
      }
    }
    integrate_erases(axis, gone, drain);
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::insert_presorted(const typename Ops::Entries& entries, Drain& drain) {
  for (const auto& entry : entries) drain.turns[entry.slot] = kNow;
  const std::pmr::vector<End> first_axis = sorted_endpoints(0, entries, drain);
  integrate_inserts(0, first_axis, drain);
  for (int axis = 1; axis < Dim; ++axis) integrate_inserts(axis, sorted_endpoints(axis, entries, drain), drain);
  for (const End end : first_axis) {
    if (end.is_max()) continue;
    report_overlaps(end.owner(), +1, drain);
    drain.turns[end.owner()] = kReported;
  }
}

template <class Scalar, int Dim>
auto SegmentedSap<Scalar, Dim>::sorted_endpoints(int axis, const typename Ops::Entries& entries, Drain& drain)
    -> std::pmr::vector<End> {
  std::pmr::vector<End> ends(drain.memory);
  ends.reserve(2 * entries.size());
  for (const auto& entry : entries) {
    ends.push_back(min_of(axis, entry.slot));
    ends.push_back(max_of(axis, entry.slot));
  }
  std::sort(ends.begin(), ends.end());
  drain.counters.endpoints_sorted += ends.size();
  return ends;
}

// ---- in one pass from left to right

// On axis 0 the pass goes on, segment by segment, as long as an erased object spans the edge behind it.
template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::integrate_erases(int axis, std::span<const End> gone, Drain& drain) {
  List& list = lists_[axis];
  std::pmr::vector<Slot> open(drain.memory);
  while (!gone.empty()) {
    SegmentId segment = segment_of(axis, gone.front());
    while (true) {
      std::size_t here = 0;
      while (here < gone.size() && segment_of(axis, gone[here]) == segment) ++here;
      if (here > 0) {
        drain.counters.endpoints_visited += list.count(segment);
        list.erase(segment, gone.first(here));
      }
      if (axis == 0) {
        open_and_close(gone.first(here), open);
        leave_checkpoint(segment, open, drain);
      }
      gone = gone.subspan(here);
      // What is merged into this segment may hold more that goes, and has an edge of its own.
      if (mergeable(axis, segment, list.next(segment))) {
        merge_next(axis, segment, drain);
        continue;
      }
      if (mergeable(axis, list.previous(segment), segment)) {
        segment = list.previous(segment);
        merge_next(axis, segment, drain);
      }
      if (open.empty()) break;
      segment = list.next(segment);
    }
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::integrate_inserts(int axis, std::span<const End> added, Drain& drain) {
  List& list = lists_[axis];
  std::pmr::vector<Slot> open(drain.memory);
  SegmentId segment = List::kNone;
  while (!added.empty()) {
    segment = open.empty() ? segment_after(axis, segment, added.front(), drain) : list.next(segment);
    std::size_t here = 0;
    while (here < added.size() && list.before_next(segment, added[here])) ++here;
    const SegmentId last = put(axis, segment, added.first(here), drain);
    if (axis != 0) {
      added = added.subspan(here);
      segment = last;
      continue;
    }
    for (SegmentId piece = segment;; piece = list.next(piece)) {
      std::size_t in_piece = 0;
      while (in_piece < here && segment_of(axis, added[in_piece]) == piece) ++in_piece;
      open_and_close(added.first(in_piece), open);
      checkpoints_.append(piece, open);
      added = added.subspan(in_piece);
      here -= in_piece;
      if (piece == last) break;
    }
    segment = last;
  }
}

/// Keeps the objects whose interval the pass is in.
template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::open_and_close(std::span<const End> ends, std::pmr::vector<Slot>& open) {
  for (const End end : ends) {
    if (end.is_max()) {
      *std::find(open.begin(), open.end(), end.owner()) = open.back();
      open.pop_back();
    } else {
      open.push_back(end.owner());
    }
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::leave_checkpoint(SegmentId segment, std::span<const Slot> gone, const Drain& drain) {
  constexpr std::size_t kFew = 4;
  if (gone.size() <= kFew) {
    for (const Slot slot : gone) checkpoints_.leave(segment, slot);
  } else {
    checkpoints_.erase_if(segment, [&](Slot slot) { return drain.turns[slot] == kReported; });
  }
}

/// The segment that `end` belongs to, mostly the one after `segment`, which lies before it.
template <class Scalar, int Dim>
auto SegmentedSap<Scalar, Dim>::segment_after(int axis, SegmentId segment, End end, Drain& drain) -> SegmentId {
  List& list = lists_[axis];
  if (segment != List::kNone && list.next(segment) != List::kNone && list.before_next(list.next(segment), end)) {
    return list.next(segment);
  }
  drain.counters.search_steps += list.search_steps();
  const SegmentId found = list.segment_for(end);
  if (axis == 0) checkpoints_.resize(list.id_bound());
  return found;
}

/// Puts sorted endpoints into the segment that they belong to, and cuts it in as many pieces as it takes. Returns the
/// last of them.
template <class Scalar, int Dim>
auto SegmentedSap<Scalar, Dim>::put(int axis, SegmentId segment, std::span<const End> added, Drain& drain)
    -> SegmentId {
  List& list = lists_[axis];
  const std::size_t total = list.count(segment) + added.size();
  if (added.empty()) return segment;
  drain.counters.endpoints_visited += total;
  if (total <= list.capacity()) {
    list.insert(segment, added);
    for (const End end : added) segment_of(axis, end) = segment;
    return segment;
  }
  std::pmr::vector<End> ends(total, drain.memory);
  std::merge(list.ends(segment), list.ends(segment) + list.count(segment), added.begin(), added.end(), ends.begin());
  // Three quarters full, so that the next endpoint finds room.
  const std::size_t room = list.capacity() * 3 / 4;
  const std::size_t pieces = (total + room - 1) / room;
  drain.counters.segments_split += pieces - 1;
  const SegmentId last = list.spread(segment, ends, pieces);
  for (SegmentId piece = segment;; piece = list.next(piece)) {
    for (const End end : std::span(list.ends(piece), list.count(piece))) segment_of(axis, end) = piece;
    if (piece == last) break;
  }
  if (axis == 0) divide_checkpoints(segment, last, drain);
  return last;
}

// The last piece ends where the whole did. What spans the other edges is found by walking back from there: a max opens
// an interval, a min closes it. Of objects on their way in, not all endpoints are there yet: they enter afterwards.
template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::divide_checkpoints(SegmentId first, SegmentId last, const Drain& drain) {
  const List& list = lists_[0];
  checkpoints_.resize(list.id_bound());
  checkpoints_.hand_over(first, last);
  for (SegmentId piece = last; piece != first; piece = list.previous(piece)) {
    const SegmentId left = list.previous(piece);
    checkpoints_.copy(piece, left);
    const End* const ends = list.ends(piece);
    for (std::uint32_t i = list.count(piece); i-- > 0;) {
      const Slot slot = ends[i].owner();
      if (drain.turns[slot] == kNow) continue;
      if (ends[i].is_max()) {
        checkpoints_.enter(left, slot);
      } else {
        checkpoints_.leave(left, slot);
      }
    }
  }
}

/// Half full at most after a merge, so that neither a split nor another merge is near.
template <class Scalar, int Dim>
bool SegmentedSap<Scalar, Dim>::mergeable(int axis, SegmentId left, SegmentId right) const {
  const List& list = lists_[axis];
  if (left == List::kNone || right == List::kNone) return false;
  return list.count(left) == 0 || list.count(right) == 0 || list.count(left) + list.count(right) <= list.capacity() / 2;
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::merge_next(int axis, SegmentId segment, Drain& drain) {
  ++drain.counters.segments_merged;
  List& list = lists_[axis];
  const SegmentId gone = list.next(segment);
  const std::uint32_t kept = list.count(segment);
  list.merge_next(segment);
  for (std::uint32_t i = kept; i < list.count(segment); ++i) segment_of(axis, list.ends(segment)[i]) = segment;
  if (axis == 0) checkpoints_.hand_over(gone, segment);
}

}  // namespace sweepgrid
