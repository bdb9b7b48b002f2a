#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>

#include <sweepgrid/sap/invariant.hpp>
#include <sweepgrid/sap/prefetch.hpp>
#include <sweepgrid/sap/segmented_sap.hpp>

namespace sweepgrid {

namespace segmented_sap {
/// Measured (sap/README.md): a global sort wins when at least one in this many residents moves.
inline constexpr std::size_t kGlobalSortShare = 4;
}  // namespace segmented_sap

template <class Scalar, int Dim>
SegmentedSap<Scalar, Dim>::SegmentedSap(int segment_capacity) {
  if (segment_capacity < 4) {
    throw std::invalid_argument("sweepgrid: segment_capacity is " + std::to_string(segment_capacity) +
                                ", but a segment needs room for at least 4 endpoints");
  }
  for (int axis = 0; axis < Dim; ++axis) lists_.emplace_back(segment_capacity);
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::drain(std::span<const Op> ops, std::vector<OverlapDelta>& deltas,
                                      SapCounters& counters) {
  DrainArena arena;
  const Ops resolved(ops, slots_, arena.resource());
  resting_.resize(slots_.slot_bound());
  Drain drain{deltas, counters};
  const std::size_t deltas_before = deltas.size();
  const std::size_t residents = size() - resolved.inserts.size();
  for (const auto& entry : resolved.erases) {
    erase(entry.slot, drain);
    slots_.release(entry.op->object);
  }
  if (segmented_sap::kGlobalSortShare * resolved.updates.size() >= residents && !resolved.updates.empty()) {
    ++counters.global_sorts;
    global_sort(resolved, drain);
  } else {
    ++counters.local_sorts;
    for (const auto& entry : resolved.updates) local_sort(entry.slot, entry.op->box, drain);
  }
  for (const auto& entry : resolved.inserts) insert(entry.slot, entry.op->box, drain);
  counters.deltas += deltas.size() - deltas_before;
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::insert(Slot slot, const OrderedBox<Scalar, Dim>& box, Drain& drain) {
  Resting& resting = resting_[slot];
  resting.box = box;
  for (int axis = 0; axis < Dim; ++axis) {
    place(axis, End::min_of(slot, box.min[axis]), drain);
    place(axis, End::max_of(slot, box.max[axis]), drain);
  }
  // Only now: the splits above computed checkpoint sets without this object, whose endpoints were not all in place.
  for (SegmentId s = resting.min_segment[0]; s != resting.max_segment[0]; s = lists_[0].next(s)) {
    checkpoints_[s].push_back(slot);
  }
  report_overlaps(slot, +1, drain);
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::erase(Slot slot, Drain& drain) {
  report_overlaps(slot, -1, drain);
  Resting& resting = resting_[slot];
  for (SegmentId s = resting.min_segment[0]; s != resting.max_segment[0]; s = lists_[0].next(s)) {
    leave_checkpoint(s, slot);
  }
  for (int axis = 0; axis < Dim; ++axis) {
    unplace(axis, End::min_of(slot, resting.box.min[axis]), drain);
    unplace(axis, End::max_of(slot, resting.box.max[axis]), drain);
  }
}

// Trailing endpoint first: a box that moves by more than its width is inverted in flight and so overlaps nothing that
// it jumps over, which saves a +1 and a -1 for each.
template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::local_sort(Slot slot, const OrderedBox<Scalar, Dim>& box, Drain& drain) {
  for (int axis = 0; axis < Dim; ++axis) {
    const End new_min = End::min_of(slot, box.min[axis]);
    const End new_max = End::max_of(slot, box.max[axis]);
    const bool rightwards = box.min[axis] > resting_[slot].box.min[axis];
    move(axis, rightwards ? new_min : new_max, drain);
    move(axis, rightwards ? new_max : new_min, drain);
    require_invariant(deferred_removes_.empty(), "S3", [] { return "a deferred remove outlived its object's flight"; });
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::global_sort(const Ops& ops, Drain& drain) {
  for (int axis = 0; axis < Dim; ++axis) {
    List& list = lists_[axis];
    // Both places are found before either value is written, so that each is still found by its old value.
    for (const auto& [slot, op] : ops.updates) {
      Resting& resting = resting_[slot];
      const SegmentId min_segment = resting.min_segment[axis];
      const SegmentId max_segment = resting.max_segment[axis];
      list.ends(min_segment)[list.offset(min_segment, End::min_of(slot, resting.box.min[axis]))] =
          End::min_of(slot, op->box.min[axis]);
      list.ends(max_segment)[list.offset(max_segment, End::max_of(slot, resting.box.max[axis]))] =
          End::max_of(slot, op->box.max[axis]);
      resting.box.min[axis] = op->box.min[axis];
      resting.box.max[axis] = op->box.max[axis];
    }
    sort_axis(axis, drain);
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::sort_axis(int axis, Drain& drain) {
  List& list = lists_[axis];
  SegmentId before = List::kNone;
  for (SegmentId segment = list.front(); segment != List::kNone; before = segment, segment = list.next(segment)) {
    End* const ends = list.ends(segment);
    for (std::uint32_t offset = 0; offset < list.count(segment); ++offset) {
      const bool in_order = offset > 0              ? ends[offset - 1] < ends[offset]
                            : before == List::kNone ? true
                                                    : list.ends(before)[list.count(before) - 1] < ends[offset];
      if (!in_order) move_left<false>(axis, {segment, offset}, ends[offset], drain);
    }
  }
}

// ---- places

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::place(int axis, End end, Drain& drain) {
  List& list = lists_[axis];
  SegmentId segment = list.segment_for(end);
  if (axis == 0) checkpoints_.resize(list.id_bound());
  if (list.full(segment)) {
    split(axis, segment, end.owner(), drain);
    segment = list.segment_for(end);
  }
  list.insert(segment, end);
  segment_of(axis, end) = segment;
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::unplace(int axis, End end, Drain& drain) {
  List& list = lists_[axis];
  const SegmentId segment = segment_of(axis, end);
  list.erase(segment, end);
  const auto mergeable = [&](SegmentId left, SegmentId right) {
    if (left == List::kNone || right == List::kNone) return false;
    // Half full at most after a merge, so that neither a split nor another merge is near.
    return list.count(segment) == 0 || list.count(left) + list.count(right) <= list.capacity() / 2;
  };
  const SegmentId previous = list.previous(segment);
  if (mergeable(segment, list.next(segment))) {
    merge_next(axis, segment, drain);
  } else if (mergeable(previous, segment)) {
    merge_next(axis, previous, drain);
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::split(int axis, SegmentId segment, Slot unplaced, Drain& drain) {
  ++drain.counters.segments_split;
  List& list = lists_[axis];
  const SegmentId upper = list.split(segment);
  const End* const ends = list.ends(upper);
  for (std::uint32_t i = 0; i < list.count(upper); ++i) segment_of(axis, ends[i]) = upper;
  if (axis != 0) return;
  // The new segment ends where the old one ended. What spans the cut is found by walking back from there: a max opens
  // an interval, a min closes it.
  checkpoints_.resize(list.id_bound());
  checkpoints_[upper] = checkpoints_[segment];
  for (std::uint32_t i = list.count(upper); i-- > 0;) {
    if (ends[i].owner() == unplaced) continue;
    if (ends[i].is_max()) {
      enter_checkpoint(segment, ends[i].owner());
    } else {
      leave_checkpoint(segment, ends[i].owner());
    }
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::merge_next(int axis, SegmentId segment, Drain& drain) {
  ++drain.counters.segments_merged;
  List& list = lists_[axis];
  const SegmentId gone = list.next(segment);
  const std::uint32_t kept = list.count(segment);
  list.merge_next(segment);
  for (std::uint32_t i = kept; i < list.count(segment); ++i) segment_of(axis, list.ends(segment)[i]) = segment;
  if (axis != 0) return;
  checkpoints_[segment].swap(checkpoints_[gone]);
  checkpoints_[gone].clear();
}

// ---- overlaps of one object with all others

// Whoever meets `slot` on axis 0 has its min inside the segments that `slot` spans, or spans the edge before them. Each
// candidate is met once: by its min, or in that one checkpoint set.
template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::report_overlaps(Slot slot, std::int32_t change, Drain& drain) {
  const List& list = lists_[0];
  const SegmentId first = resting_[slot].min_segment[0];
  if (list.previous(first) != List::kNone) {
    for (const Slot other : checkpoints_[list.previous(first)]) test(slot, other, change, drain);
  }
  for (SegmentId segment = first;; segment = list.next(segment)) {
    const End* const ends = list.ends(segment);
    for (std::uint32_t i = 0; i < list.count(segment); ++i) {
      if (!ends[i].is_max() && ends[i].owner() != slot) test(slot, ends[i].owner(), change, drain);
    }
    if (segment == resting_[slot].max_segment[0]) return;
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::test(Slot slot, Slot other, std::int32_t change, Drain& drain) {
  ++drain.counters.box_tests;
  if (resting_[slot].box.overlaps(resting_[other].box)) {
    drain.deltas.push_back({PairKey(slots_.object(slot), slots_.object(other)), change});
  }
}

// ---- movement

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::move(int axis, End end, Drain& drain) {
  List& list = lists_[axis];
  Resting& resting = resting_[end.owner()];
  auto& coordinate = end.is_max() ? resting.box.max[axis] : resting.box.min[axis];
  const End old = end.is_max() ? End::max_of(end.owner(), coordinate) : End::min_of(end.owner(), coordinate);
  if (end == old) return;
  const SegmentId segment = segment_of(axis, end);
  const Place place{segment, list.offset(segment, old)};
  coordinate = end.value();
  if (end < old) {
    move_left<true>(axis, place, end, drain);
  } else {
    move_right(axis, place, end, drain);
  }
}

template <class Scalar, int Dim>
template <bool kInFlight>
void SegmentedSap<Scalar, Dim>::move_left(int axis, Place place, End end, Drain& drain) {
  List& list = lists_[axis];
  while (true) {
    if (place.offset > 0) {
      End* const ends = list.ends(place.segment);
      const End other = ends[place.offset - 1];
      if (other < end) break;
      ends[place.offset--] = other;
      swapped<kInFlight>(axis, other, end, drain);
    } else {
      const SegmentId left = list.previous(place.segment);
      if (left == List::kNone) break;
      const End other = list.ends(left)[list.count(left) - 1];
      if (other < end) break;
      list.at(place) = other;
      cross_right(axis, other, left, place.segment);
      cross_left(axis, end, left);
      place = {left, list.count(left) - 1};
      swapped<kInFlight>(axis, other, end, drain);
    }
  }
  list.at(place) = end;
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::move_right(int axis, Place place, End end, Drain& drain) {
  List& list = lists_[axis];
  while (true) {
    if (place.offset + 1 < list.count(place.segment)) {
      End* const ends = list.ends(place.segment);
      const End other = ends[place.offset + 1];
      if (end < other) break;
      ends[place.offset++] = other;
      swapped<true>(axis, end, other, drain);
    } else {
      const SegmentId right = list.next(place.segment);
      if (right == List::kNone) break;
      const End other = list.ends(right)[0];
      if (end < other) break;
      list.at(place) = other;
      cross_left(axis, other, place.segment);
      cross_right(axis, end, place.segment, right);
      place = {right, 0};
      swapped<true>(axis, end, other, drain);
    }
  }
  list.at(place) = end;
}

template <class Scalar, int Dim>
template <bool kInFlight>
void SegmentedSap<Scalar, Dim>::swapped(int axis, End left, End right, Drain& drain) {
  ++drain.counters.swaps;
  if (left.is_max() == right.is_max() || left.owner() == right.owner()) return;
  const auto& a = resting_[left.owner()].box;
  const auto& b = resting_[right.owner()].box;
  // A max on the left means that the intervals were apart and now meet. That holds only if their other ends are in
  // order too, which they always are unless a box is inverted in flight.
  const bool begins = left.is_max();
  if constexpr (kInFlight) {
    const bool others_meet = begins ? a.min[axis] <= b.max[axis] : b.min[axis] <= a.max[axis];
    if (!others_meet) return;
  }
  ++drain.counters.box_tests;
  if (a.overlaps_beside(axis, b)) {
    drain.deltas.push_back({PairKey(slots_.object(left.owner()), slots_.object(right.owner())), begins ? +1 : -1});
  }
}

// ---- checkpoint sets

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::cross_right(int axis, End end, SegmentId from, SegmentId to) {
  segment_of(axis, end) = to;
  if (axis != 0) return;
  if (end.is_max()) {
    enter_checkpoint(from, end.owner());
  } else {
    leave_checkpoint(from, end.owner());
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::cross_left(int axis, End end, SegmentId to) {
  segment_of(axis, end) = to;
  if (axis != 0) return;
  if (end.is_max()) {
    leave_checkpoint(to, end.owner());
  } else {
    enter_checkpoint(to, end.owner());
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::enter_checkpoint(SegmentId segment, Slot slot) {
  const auto deferred = std::find(deferred_removes_.begin(), deferred_removes_.end(), std::pair{segment, slot});
  if (deferred == deferred_removes_.end()) {
    checkpoints_[segment].push_back(slot);
  } else {
    *deferred = deferred_removes_.back();
    deferred_removes_.pop_back();
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::leave_checkpoint(SegmentId segment, Slot slot) {
  std::vector<Slot>& checkpoint = checkpoints_[segment];
  const auto found = std::find(checkpoint.begin(), checkpoint.end(), slot);
  if (found == checkpoint.end()) {
    deferred_removes_.emplace_back(segment, slot);
  } else {
    *found = checkpoint.back();
    checkpoint.pop_back();
  }
}

// ---- the rest

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::prefetch() const {
  slots_.prefetch();
  sweepgrid::prefetch(resting_.data(), resting_.size() * sizeof(Resting));
  for (const List& list : lists_) list.prefetch();
}

template <class Scalar, int Dim>
std::size_t SegmentedSap<Scalar, Dim>::bytes() const {
  std::size_t total = sizeof(*this) + slots_.bytes() + resting_.capacity() * sizeof(Resting);
  for (const List& list : lists_) total += sizeof(list) + list.bytes();
  total += checkpoints_.capacity() * sizeof(checkpoints_[0]);
  for (const auto& checkpoint : checkpoints_) total += checkpoint.capacity() * sizeof(Slot);
  return total;
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::append_residents(std::vector<Resident>& residents) const {
  for (Slot slot = 0; slot < slots_.slot_bound(); ++slot) {
    if (slots_.object(slot) != kNoObject) residents.push_back({slots_.object(slot), resting_[slot].box});
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::validate() const {
  for (int axis = 0; axis < Dim; ++axis) {
    const List& list = lists_[axis];
    const auto where = [&] { return "interval list of axis " + std::to_string(axis); };
    std::vector<char> open(slots_.slot_bound(), 0);
    std::size_t ends = 0;
    std::vector<Slot> spanning;
    for (const SegmentId segment : list.directory()) {
      for (std::uint32_t i = 0; i < list.count(segment); ++i, ++ends) {
        const End end = list.ends(segment)[i];
        const Resting& resting = resting_[end.owner()];
        require_invariant(i == 0 || list.ends(segment)[i - 1] < end, "S1", [&] { return where() + " is unordered"; });
        require_invariant(i > 0 || list.previous(segment) == List::kNone ||
                              list.ends(list.previous(segment))[list.count(list.previous(segment)) - 1] < end,
                          "S1", [&] { return where() + " is unordered between segments"; });
        const bool placed = end.is_max() ? resting.max_segment[axis] == segment && resting.box.max[axis] == end.value()
                                         : resting.min_segment[axis] == segment && resting.box.min[axis] == end.value();
        require_invariant(
            slots_.object(end.owner()) != kNoObject && placed && open[end.owner()] == (end.is_max() ? 1 : 0), "S2",
            [&] { return where() + " holds a stray endpoint of slot " + std::to_string(end.owner()); });
        open[end.owner()] = end.is_max() ? 2 : 1;
      }
      if (axis != 0) continue;
      spanning.clear();
      for (Slot slot = 0; slot < open.size(); ++slot) {
        if (open[slot] == 1) spanning.push_back(slot);
      }
      std::vector<Slot> checkpoint = checkpoints_[segment];
      std::sort(checkpoint.begin(), checkpoint.end());
      require_invariant(checkpoint == spanning, "S3",
                        [&] { return "checkpoint set of segment " + std::to_string(segment) + " is not exact"; });
    }
    require_invariant(ends == 2 * size(), "S2", [&] { return where() + " does not hold two endpoints per object"; });
  }
}

}  // namespace sweepgrid
