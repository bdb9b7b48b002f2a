#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include <sweepgrid/sap/endpoint.hpp>
#include <sweepgrid/sap/object_slots.hpp>
#include <sweepgrid/sap/resolved_ops.hpp>
#include <sweepgrid/sap/sweep_and_prune.hpp>
#include <sweepgrid/sap/sweep_sets.hpp>

namespace sweepgrid {

/// Sweep and prune with batch insertion and removal (section 3.2.1): one pass over each interval list sorts it and
/// integrates all inserts and erases, in O(k(m log m + n) + swaps). Few updates and nothing else: a local sort instead.
///
/// No set of pairs is kept. Axes are sorted one after another, and overlap on the other axes is read from ranks: axes
/// already sorted speak of the new boxes, the others of the old. Each swap then changes the pair's state by exactly
/// what it reports, and over all axes the deltas sum to new state minus old state.
template <class Scalar, int Dim>
class BatchSap final : public SweepAndPrune<Scalar, Dim> {
 public:
  using Base = SweepAndPrune<Scalar, Dim>;
  using typename Base::Op;
  using typename Base::Resident;

  void drain(std::span<const Op> ops, DeltaList& deltas, SapCounters& counters) override;
  /// Sorts the lists anew, O(n log n): no pair is looked at.
  void transfer(std::span<const Op> ops, SapCounters& counters) override;
  void prefetch() const override;
  [[nodiscard]] std::size_t size() const override { return slots_.size(); }
  [[nodiscard]] std::size_t bytes() const override;
  void append_residents(std::vector<Resident>& residents) const override;
  void validate() const override;

 private:
  using End = Endpoint<Scalar>;
  using Ops = ResolvedOps<Scalar, Dim>;

  /// An interval list that floats in a larger array (Figures 5 and 6): the gap before `begin` lets a forward pass
  /// write inserts without overtaking its reading; the room behind `end` serves a backward pass.
  struct FloatingList {
    std::vector<End> storage;
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
  };

  /// Places of an object's endpoints in the lists' storage, by axis. Only their order and equality with the true
  /// place matter, so a list may float. An empty interval (min above max) overlaps nothing.
  struct Ranks {
    std::array<std::uint32_t, Dim> min;
    std::array<std::uint32_t, Dim> max;
  };
  static constexpr Ranks kEmptyRanks = [] {
    Ranks ranks{};
    ranks.min.fill(0xffffffffU);
    return ranks;
  }();

  /// What one drain passes around.
  struct Drain {
    DeltaList& deltas;
    SapCounters& counters;
    std::pmr::memory_resource* memory;
  };

  /// What one integrating pass over one axis reads and where it writes.
  struct Integration;

  void local_sort(const Ops& ops, Drain& drain);
  void global_sort(const Ops& ops, Drain& drain);
  void integrate(const Ops& ops, Drain& drain);
  void integrate_few(const Ops& ops, Drain& drain);
  void write_updates(int axis, const Ops& ops);
  void sort_in_place(int axis, Drain& drain);
  /// Moves an endpoint to the place of its new value, while everything else is in order.
  void move(int axis, End end, Drain& drain);
  void move_right(int axis, std::uint32_t place, End end, Drain& drain);
  void move_left(int axis, std::uint32_t place, End end, Drain& drain);
  void integrate_axis(int axis, const Ops& ops, SweepSets* sets, Drain& drain);
  template <bool kForward>
  void pass(const Integration& in, Drain& drain);
  template <bool kForward>
  void sweep(const Integration& in, SweepSets::Set own, End end, SweepSets::Set first, SweepSets::Set second,
             std::int32_t change, Drain& drain);
  template <bool kForward>
  void sweep_retained(const Integration& in, End end, Drain& drain);
  void test_against(const Integration& in, SweepSets::Set set, Slot slot, std::int32_t change, Drain& drain);
  void test_against_all(Slot slot, std::int32_t change, Drain& drain);
  void read_ranks(int axis);
  void shrink(FloatingList& list);

  [[nodiscard]] std::uint32_t& rank(int axis, End end) {
    Ranks& ranks = ranks_[end.owner()];
    return end.is_max() ? ranks.max[axis] : ranks.min[axis];
  }
  [[nodiscard]] bool overlap_beside(int axis, Slot a, Slot b) const;
  /// `left` and `right`, neighbours in that order, have changed places.
  template <bool kInFlight>
  void swapped(int axis, End left, End right, Drain& drain);
  void report(Slot a, Slot b, std::int32_t change, Drain& drain);

  ObjectSlots slots_;
  std::vector<Ranks> ranks_;  // by slot
  std::array<FloatingList, Dim> lists_;
};

}  // namespace sweepgrid
