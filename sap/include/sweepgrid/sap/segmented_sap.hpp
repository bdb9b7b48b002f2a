#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include <sweepgrid/sap/cell_kind.hpp>
#include <sweepgrid/sap/object_slots.hpp>
#include <sweepgrid/sap/resolved_ops.hpp>
#include <sweepgrid/sap/segmented_checkpoints.hpp>
#include <sweepgrid/sap/segmented_list.hpp>
#include <sweepgrid/sap/segmented_passed.hpp>
#include <sweepgrid/sap/sweep_and_prune.hpp>

namespace sweepgrid {

/// Sweep and prune on segmented interval lists (section 3.2.2): an insert or erase touches the segments that the box
/// spans, found by binary search, and nothing else; updates are sorted locally or, when many, globally. Many inserts
/// and erases are sorted first and integrated segment by segment in one pass (the end of sections 4.1 and 4.2).
///
/// No set of pairs is kept; see BatchSap for why the deltas are exact. Here overlap on the other axes is read from the
/// boxes by slot, which take each axis's new interval when that axis is sorted.
template <class Scalar, int Dim>
class SegmentedSap final : public SweepAndPrune<Scalar, Dim> {
 public:
  using Base = SweepAndPrune<Scalar, Dim>;
  using typename Base::Op;
  using typename Base::Resident;

  /// Throws std::invalid_argument for a capacity that is not within 4 and CellOptions::kMostSegmentCapacity.
  explicit SegmentedSap(int segment_capacity, Integration integration = Integration::kAuto);

  void drain(std::span<const Op> ops, DeltaList& deltas, SapCounters& counters) override;
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
  using OrderedBoxType = OrderedBox<Scalar, Dim>;
  using Passed = SegmentedPassed<Scalar>;

  struct Resting {
    OrderedBoxType box;
    std::array<SegmentId, Dim> min_segment;
    std::array<SegmentId, Dim> max_segment;
  };

  /// What one drain passes around.
  struct Drain {
    DeltaList& deltas;
    SapCounters& counters;
    std::pmr::memory_resource* memory;
    /// By slot, of the objects that come or go; empty when none does.
    std::pmr::vector<std::uint8_t> turns;
  };
  static constexpr std::uint8_t kNow = 1;       // its endpoints are on their way in or out
  static constexpr std::uint8_t kReported = 2;  // its pairs have been said

  // Inserts and erases (segmented_integration.inl.hpp).
  void erase(const typename Ops::Entries& entries, Drain& drain);
  void insert(const typename Ops::Entries& entries, Drain& drain);
  void erase_presorted(const typename Ops::Entries& entries, Drain& drain);
  void insert_presorted(const typename Ops::Entries& entries, Drain& drain);
  void erase_one(Slot slot, Drain& drain);
  void insert_one(Slot slot, Drain& drain);
  [[nodiscard]] std::pmr::vector<End> sorted_endpoints(int axis, const typename Ops::Entries& entries, Drain& drain);
  void integrate_erases(int axis, std::span<const End> gone, Drain& drain);
  void integrate_inserts(int axis, std::span<const End> added, Drain& drain);
  static void open_and_close(std::span<const End> ends, std::pmr::vector<Slot>& open);
  void leave_checkpoint(SegmentId segment, std::span<const Slot> gone, const Drain& drain);
  [[nodiscard]] SegmentId segment_after(int axis, SegmentId segment, End end, Drain& drain);
  SegmentId put(int axis, SegmentId segment, std::span<const End> added, Drain& drain);
  void divide_checkpoints(SegmentId first, SegmentId last, const Drain& drain);
  [[nodiscard]] bool mergeable(int axis, SegmentId left, SegmentId right) const;
  void merge_next(int axis, SegmentId segment, Drain& drain);

  // Overlaps of one object with many.
  void report_overlaps(Slot slot, std::int32_t change, Drain& drain);
  template <class Hit>
  void test(std::span<const Slot> slots, const OrderedBoxType& box, Drain& drain, Hit hit) const;
  template <class Hit>
  void test_owners(std::span<const End> ends, bool of_maxes, const OrderedBoxType& box, Drain& drain, Hit hit) const;

  // Updates (segmented_motion.inl.hpp).
  void local_sort(Slot slot, const OrderedBoxType& box, Drain& drain);
  void global_sort(const Ops& ops, Drain& drain);
  void sort_axis(int axis, Drain& drain);
  /// Sets one coordinate to `end` and moves it to its place, while everything else is in order.
  void move(int axis, End end, Drain& drain);
  void move_left(int axis, Place place, End end, const OrderedBoxType& probe, Drain& drain);
  void move_right(int axis, Place place, End end, const OrderedBoxType& probe, Drain& drain);
  void report_passed(Passed& passed, bool begins, const OrderedBoxType& probe, Drain& drain);
  void cross_right(int axis, End end, SegmentId from, SegmentId to);
  void cross_left(int axis, End end, SegmentId to);

  void validate_axis(int axis) const;

  [[nodiscard]] End min_of(int axis, Slot slot) const { return End::min_of(slot, resting_[slot].box.min[axis]); }
  [[nodiscard]] End max_of(int axis, Slot slot) const { return End::max_of(slot, resting_[slot].box.max[axis]); }
  [[nodiscard]] SegmentId& segment_of(int axis, End end) {
    Resting& resting = resting_[end.owner()];
    return end.is_max() ? resting.max_segment[axis] : resting.min_segment[axis];
  }

  Integration integration_;
  ObjectSlots slots_;
  std::vector<Resting> resting_;      // by slot
  std::vector<List> lists_;           // by axis
  SegmentedCheckpoints checkpoints_;  // of axis 0
};

}  // namespace sweepgrid
