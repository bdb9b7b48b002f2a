#pragma once

#include <algorithm>
#include <span>

#include <sweepgrid/sap/invariant.hpp>
#include <sweepgrid/sap/segmented_sap.hpp>

namespace sweepgrid {

// Trailing endpoint first: a box that moves by more than its width is inverted in flight and so overlaps nothing that
// it jumps over, which saves a +1 and a -1 for each.
template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::local_sort(Slot slot, const OrderedBoxType& box, Drain& drain) {
  for (int axis = 0; axis < Dim; ++axis) {
    const End new_min = End::min_of(slot, box.min[axis]);
    const End new_max = End::max_of(slot, box.max[axis]);
    const bool rightwards = box.min[axis] > resting_[slot].box.min[axis];
    move(axis, rightwards ? new_min : new_max, drain);
    move(axis, rightwards ? new_max : new_min, drain);
    require_invariant(checkpoints_.settled(), "S3", [] { return "a deferred remove outlived its object's flight"; });
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::global_sort(const Ops& ops, Drain& drain) {
  for (int axis = 0; axis < Dim; ++axis) {
    for (const auto& [slot, op] : ops.updates) {
      resting_[slot].box.min[axis] = op->box.min[axis];
      resting_[slot].box.max[axis] = op->box.max[axis];
    }
    sort_axis(axis, drain);
  }
}

// Reads every value anew: to look up the few that have not moved would take longer.
template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::sort_axis(int axis, Drain& drain) {
  List& list = lists_[axis];
  drain.counters.endpoints_visited += 2 * size();
  End before = list.ends(list.front())[0];  // the greatest so far
  for (SegmentId segment = list.front(); segment != List::kNone; segment = list.next(segment)) {
    End* const ends = list.ends(segment);
    for (std::uint32_t offset = 0; offset < list.count(segment); ++offset) {
      const Slot slot = ends[offset].owner();
      const End end = ends[offset].is_max() ? max_of(axis, slot) : min_of(axis, slot);
      ends[offset] = end;
      if (before < end || (segment == list.front() && offset == 0)) {
        before = end;
        continue;
      }
      // The other ends of two boxes that pass are in order, as no box is inverted now; the axis need not be asked.
      move_left(axis, {segment, offset}, end, resting_[slot].box.opened(axis, true, true), drain);
      before = ends[offset];
    }
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::move(int axis, End end, Drain& drain) {
  const Slot slot = end.owner();
  OrderedBoxType& box = resting_[slot].box;
  const End old = end.is_max() ? max_of(axis, slot) : min_of(axis, slot);
  if (end == old) return;
  // On this axis, two boxes meet or part as their endpoints pass only if their other ends are in order; which they
  // always are unless a box is inverted in flight.
  const OrderedBoxType probe = box.opened(axis, !end.is_max(), end.is_max());
  (end.is_max() ? box.max : box.min)[axis] = end.value();
  const SegmentId segment = segment_of(axis, end);
  const Place place{segment, lists_[axis].offset(segment, old)};
  if (end < old) {
    move_left(axis, place, end, probe, drain);
  } else {
    move_right(axis, place, end, probe, drain);
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::move_left(int axis, Place place, End end, const OrderedBoxType& probe, Drain& drain) {
  List& list = lists_[axis];
  Passed passed(end);
  while (true) {
    End* const ends = list.ends(place.segment);
    std::uint32_t to = place.offset;
    const std::uint32_t stop = to - std::min(to, passed.room());
    for (; to > stop && end < ends[to - 1]; --to) passed.add(ends[to] = ends[to - 1]);
    place.offset = to;
    if (to == stop && to > 0) {
      report_passed(passed, !end.is_max(), probe, drain);
      continue;
    }
    const SegmentId left = to > 0 ? List::kNone : list.previous(place.segment);
    if (left == List::kNone || list.last(left) < end) break;
    const End other = list.last(left);
    if (passed.room() == 0) report_passed(passed, !end.is_max(), probe, drain);
    passed.add(ends[0] = other);
    cross_right(axis, other, left, place.segment);
    cross_left(axis, end, left);
    place = {left, list.count(left) - 1};
  }
  list.at(place) = end;
  report_passed(passed, !end.is_max(), probe, drain);
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::move_right(int axis, Place place, End end, const OrderedBoxType& probe, Drain& drain) {
  List& list = lists_[axis];
  Passed passed(end);
  while (true) {
    End* const ends = list.ends(place.segment);
    const std::uint32_t last = list.count(place.segment) - 1;
    std::uint32_t to = place.offset;
    const std::uint32_t stop = to + std::min(last - to, passed.room());
    for (; to < stop && ends[to + 1] < end; ++to) passed.add(ends[to] = ends[to + 1]);
    place.offset = to;
    if (to == stop && to < last) {
      report_passed(passed, end.is_max(), probe, drain);
      continue;
    }
    const SegmentId right = to < last ? List::kNone : list.next(place.segment);
    if (right == List::kNone || end < list.ends(right)[0]) break;
    const End other = list.ends(right)[0];
    if (passed.room() == 0) report_passed(passed, end.is_max(), probe, drain);
    passed.add(ends[last] = other);
    cross_left(axis, other, place.segment);
    cross_right(axis, end, place.segment, right);
    place = {right, 0};
  }
  list.at(place) = end;
  report_passed(passed, end.is_max(), probe, drain);
}

// Where a min and a max pass, the pair meets or parts on this axis.
template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::report_passed(Passed& passed, bool begins, const OrderedBoxType& probe, Drain& drain) {
  drain.counters.swaps += passed.swaps();
  test(passed.opposite(), probe, drain, [&](Slot other) {
    if (other == passed.mover()) return;
    drain.deltas.push_back({PairKey(slots_.object(passed.mover()), slots_.object(other)), begins ? +1 : -1});
  });
  passed.clear();
}

// ---- across the edge between two segments

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::cross_right(int axis, End end, SegmentId from, SegmentId to) {
  segment_of(axis, end) = to;
  if (axis != 0) return;
  if (end.is_max()) {
    checkpoints_.enter(from, end.owner());
  } else {
    checkpoints_.leave(from, end.owner());
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::cross_left(int axis, End end, SegmentId to) {
  segment_of(axis, end) = to;
  if (axis != 0) return;
  if (end.is_max()) {
    checkpoints_.leave(to, end.owner());
  } else {
    checkpoints_.enter(to, end.owner());
  }
}

}  // namespace sweepgrid
