#pragma once

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include <sweepgrid/sap/invariant.hpp>
#include <sweepgrid/sap/prefetch.hpp>
#include <sweepgrid/sap/segmented_integration.inl.hpp>
#include <sweepgrid/sap/segmented_motion.inl.hpp>
#include <sweepgrid/sap/segmented_sap.hpp>

namespace sweepgrid {

namespace segmented_sap {
/// Measured (sap/README.md): a global sort wins when at least one in this many residents moves.
inline constexpr std::size_t kGlobalSortShare = 2;
}  // namespace segmented_sap

template <class Scalar, int Dim>
SegmentedSap<Scalar, Dim>::SegmentedSap(int segment_capacity, Integration integration) : integration_(integration) {
  if (segment_capacity < 4) {
    throw std::invalid_argument("sweepgrid: segment_capacity is " + std::to_string(segment_capacity) +
                                ", but a segment needs room for at least 4 endpoints");
  }
  if (segment_capacity > CellOptions::kMostSegmentCapacity) {
    throw std::invalid_argument("sweepgrid: segment_capacity is " + std::to_string(segment_capacity) +
                                ", but must be at most " + std::to_string(CellOptions::kMostSegmentCapacity));
  }
  for (int axis = 0; axis < Dim; ++axis) lists_.emplace_back(segment_capacity);
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::drain(std::span<const Op> ops, DeltaList& deltas, SapCounters& counters) {
  DrainArena arena(deltas);
  const Ops resolved(ops, slots_, arena.resource());
  resting_.resize(slots_.slot_bound());
  const bool comes_or_goes = !resolved.inserts.empty() || !resolved.erases.empty();
  Drain drain{deltas, counters, arena.resource(),
              std::pmr::vector<std::uint8_t>(comes_or_goes ? slots_.slot_bound() : 0, arena.resource())};
  const std::size_t deltas_before = deltas.size();
  const std::size_t residents = size() - resolved.inserts.size();
  erase(resolved.erases, drain);
  if (segmented_sap::kGlobalSortShare * resolved.updates.size() >= residents && !resolved.updates.empty()) {
    ++counters.global_sorts;
    global_sort(resolved, drain);
  } else {
    ++counters.local_sorts;
    for (const auto& entry : resolved.updates) local_sort(entry.slot, entry.op->box, drain);
  }
  insert(resolved.inserts, drain);
  counters.deltas += deltas.size() - deltas_before;
}

// ---- overlaps of one object with many

// Whoever meets `slot` on axis 0 has its min in the segments that `slot` spans, up to the max of `slot`, or spans the
// edge before them. Each is met once: by its min, or in that one checkpoint set.
template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::report_overlaps(Slot slot, std::int32_t change, Drain& drain) {
  const List& list = lists_[0];
  const Resting& resting = resting_[slot];
  const auto hit = [&](Slot other) {
    if (other == slot || drain.turns[other] == kReported) return;
    drain.deltas.push_back({PairKey(slots_.object(slot), slots_.object(other)), change});
  };
  SegmentId segment = resting.min_segment[0];
  if (list.previous(segment) != List::kNone) {
    test(checkpoints_.members(list.previous(segment)), resting.box, drain, hit);
  }
  for (bool more = true; more; segment = list.next(segment)) {
    more = segment != resting.max_segment[0];
    const std::uint32_t count = more ? list.count(segment) : list.offset(segment, max_of(0, slot));
    drain.counters.endpoints_visited += count;
    test_owners({list.ends(segment), count}, false, resting.box, drain, hit);
  }
}

template <class Scalar, int Dim>
template <class Hit>
void SegmentedSap<Scalar, Dim>::test(std::span<const Slot> slots, const OrderedBoxType& box, Drain& drain,
                                     Hit hit) const {
  drain.counters.box_tests += slots.size();
  for (const Slot slot : slots) {
    if (box.overlaps(resting_[slot].box)) hit(slot);
  }
}

// The owners first, without a branch: whether an endpoint is a min or a max cannot be predicted.
template <class Scalar, int Dim>
template <class Hit>
void SegmentedSap<Scalar, Dim>::test_owners(std::span<const End> ends, bool of_maxes, const OrderedBoxType& box,
                                            Drain& drain, Hit hit) const {
  std::array<Slot, 32> owners;
  while (!ends.empty()) {
    const std::size_t block = std::min(ends.size(), owners.size());
    std::size_t found = 0;
    for (const End end : ends.first(block)) {
      owners[found] = end.owner();
      found += end.is_max() == of_maxes ? 1 : 0;
    }
    test({owners.data(), found}, box, drain, hit);
    ends = ends.subspan(block);
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
  return total + checkpoints_.bytes();
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::append_residents(std::vector<Resident>& residents) const {
  for (Slot slot = 0; slot < slots_.slot_bound(); ++slot) {
    if (slots_.object(slot) != kNoObject) residents.push_back({slots_.object(slot), resting_[slot].box});
  }
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::validate() const {
  for (int axis = 0; axis < Dim; ++axis) validate_axis(axis);
}

template <class Scalar, int Dim>
void SegmentedSap<Scalar, Dim>::validate_axis(int axis) const {
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
    std::vector<Slot> checkpoint = checkpoints_.members(segment);
    std::sort(checkpoint.begin(), checkpoint.end());
    require_invariant(checkpoint == spanning, "S3",
                      [&] { return "checkpoint set of segment " + std::to_string(segment) + " is not exact"; });
  }
  require_invariant(ends == 2 * size(), "S2", [&] { return where() + " does not hold two endpoints per object"; });
}

}  // namespace sweepgrid
