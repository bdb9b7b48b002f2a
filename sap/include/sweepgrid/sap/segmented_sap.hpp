#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <sweepgrid/sap/object_slots.hpp>
#include <sweepgrid/sap/resolved_ops.hpp>
#include <sweepgrid/sap/segmented_list.hpp>
#include <sweepgrid/sap/sweep_and_prune.hpp>

namespace sweepgrid {

/// Sweep and prune on segmented interval lists (section 3.2.2): an insert or erase touches the segments that the box
/// spans, found by binary search, and nothing else; updates are sorted locally or, when many, globally.
///
/// No set of pairs is kept; see BatchSap for why the deltas are exact. Here overlap on the other axes is read from the
/// boxes by slot, which take each axis's new interval when that axis is sorted.
template <class Scalar, int Dim>
class SegmentedSap final : public SweepAndPrune<Scalar, Dim> {
 public:
  using Base = SweepAndPrune<Scalar, Dim>;
  using typename Base::Op;
  using typename Base::Resident;

  /// Throws std::invalid_argument below 4 endpoints per segment.
  explicit SegmentedSap(int segment_capacity);

  void drain(std::span<const Op> ops, std::vector<OverlapDelta>& deltas, SapCounters& counters) override;
  void prefetch() const override;
  [[nodiscard]] std::size_t size() const override { return slots_.size(); }
  [[nodiscard]] std::size_t bytes() const override;
  void append_residents(std::vector<Resident>& residents) const override;
  void validate() const override;

 private:
  using End = Endpoint<Scalar>;
  using List = SegmentedList<Scalar>;
  using SegmentId = typename List::SegmentId;
  using Place = typename List::Place;
  using Ops = ResolvedOps<Scalar, Dim>;

  struct Resting {
    OrderedBox<Scalar, Dim> box;
    std::array<SegmentId, Dim> min_segment;
    std::array<SegmentId, Dim> max_segment;
  };

  struct Drain {
    std::vector<OverlapDelta>& deltas;
    SapCounters& counters;
  };

  void insert(Slot slot, const OrderedBox<Scalar, Dim>& box, Drain& drain);
  void erase(Slot slot, Drain& drain);
  void local_sort(Slot slot, const OrderedBox<Scalar, Dim>& box, Drain& drain);
  void global_sort(const Ops& ops, Drain& drain);
  void sort_axis(int axis, Drain& drain);

  void place(int axis, End end, Drain& drain);
  void unplace(int axis, End end, Drain& drain);
  void split(int axis, SegmentId segment, Slot unplaced, Drain& drain);
  void merge_next(int axis, SegmentId segment, Drain& drain);
  void report_overlaps(Slot slot, std::int32_t change, Drain& drain);
  void test(Slot slot, Slot other, std::int32_t change, Drain& drain);

  /// Sets one coordinate to `end` and moves it to its place, while everything else is in order.
  void move(int axis, End end, Drain& drain);
  template <bool kInFlight>
  void move_left(int axis, Place place, End end, Drain& drain);
  void move_right(int axis, Place place, End end, Drain& drain);
  template <bool kInFlight>
  void swapped(int axis, End left, End right, Drain& drain);

  void cross_right(int axis, End end, SegmentId from, SegmentId to);
  void cross_left(int axis, End end, SegmentId to);
  void enter_checkpoint(SegmentId segment, Slot slot);
  void leave_checkpoint(SegmentId segment, Slot slot);

  [[nodiscard]] SegmentId& segment_of(int axis, End end) {
    Resting& resting = resting_[end.owner()];
    return end.is_max() ? resting.max_segment[axis] : resting.min_segment[axis];
  }

  ObjectSlots slots_;
  std::vector<Resting> resting_;  // by slot
  std::vector<List> lists_;       // by axis

  /// S3, by segment of axis 0: exactly the objects whose interval spans the segment's trailing edge, that is, whose
  /// min lies in it or to its left and whose max lies to its right. Unordered, no duplicates. Lets an insert see boxes
  /// whose endpoints lie arbitrarily far away.
  std::vector<std::vector<Slot>> checkpoints_;

  /// The paper's set R: checkpoint sets that the object in flight left before it entered, because its trailing endpoint
  /// overtook the leading one. Entering takes the entry back. Empty between objects.
  std::vector<std::pair<SegmentId, Slot>> deferred_removes_;
};

}  // namespace sweepgrid
