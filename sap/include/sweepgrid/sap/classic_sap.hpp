#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <sweepgrid/sap/endpoint.hpp>
#include <sweepgrid/sap/invariant.hpp>
#include <sweepgrid/sap/object_slots.hpp>
#include <sweepgrid/sap/resolved_ops.hpp>
#include <sweepgrid/sap/sweep_and_prune.hpp>

namespace sweepgrid {

/// Baraff's sweep and prune (paper, section 2): one array of endpoints per axis, insertion-sorted whole at every drain
/// with ops. O(n + swaps) per drain; an insert or erase costs O(n) swaps on each axis. The baseline of Figure 2.
///
/// No set of pairs is kept. The axes are sorted one after another, and a swap speaks iff the two boxes meet on all
/// other axes, where sorted axes hold the new boxes and unsorted ones the old. Summed over the axes a pair's deltas
/// telescope to its state after minus its state before.
template <class Scalar, int Dim>
class ClassicSap final : public SweepAndPrune<Scalar, Dim> {
 public:
  using typename SweepAndPrune<Scalar, Dim>::Op;
  using typename SweepAndPrune<Scalar, Dim>::Resident;

  void drain(std::span<const Op> ops, DeltaList& deltas, SapCounters& counters) override;
  [[nodiscard]] std::size_t size() const override { return slots_.size(); }
  [[nodiscard]] std::size_t bytes() const override;
  void append_residents(std::vector<Resident>& residents) const override;

  /// S1 and S2.
  void validate() const override;

 private:
  using Key = Endpoint<Scalar>;
  using Ops = ResolvedOps<Scalar, Dim>;

  // What a drain does to an object, as bits. An inserted object's endpoints start behind all others, where it overlaps
  // nothing, and so do an erased object's end; a value alone could not say so, for a real box may reach all ones.
  static constexpr std::uint8_t kInserted = 1;
  static constexpr std::uint8_t kErased = 2;

  void write_axis(int axis, const Ops& ops);
  template <class Precedes>
  void sort(int axis, Precedes precedes, DeltaList& deltas, SapCounters& counters);
  void swapped(int axis, Key to_left, Key to_right, DeltaList& deltas, SapCounters& counters) const;
  [[nodiscard]] bool erased_last(Key a, Key b) const;
  void validate_axis(int axis) const;

  ObjectSlots slots_;
  std::vector<OrderedBox<Scalar, Dim>> boxes_;  // by slot
  std::vector<std::uint8_t> change_;            // by slot; all 0 between drains
  std::array<std::vector<Key>, Dim> lists_;     // the interval lists, by axis
};

template <class Scalar, int Dim>
void ClassicSap<Scalar, Dim>::drain(std::span<const Op> ops, DeltaList& deltas, SapCounters& counters) {
  DrainArena arena(deltas);
  const Ops resolved(ops, slots_, arena.resource());
  if (ops.empty()) return;
  ++counters.global_sorts;
  boxes_.resize(slots_.slot_bound());
  change_.resize(slots_.slot_bound());
  for (const auto& entry : resolved.inserts) change_[entry.slot] = kInserted;
  for (const auto& entry : resolved.erases) change_[entry.slot] = kErased;
  for (int axis = 0; axis < Dim; ++axis) {
    write_axis(axis, resolved);
    if (resolved.erases.empty()) {
      sort(axis, std::less<>(), deltas, counters);
    } else {
      sort(
          axis, [this](Key a, Key b) { return erased_last(a, b); }, deltas, counters);
    }
    lists_[axis].resize(lists_[axis].size() - 2 * resolved.erases.size());
  }
  for (const auto& entry : resolved.inserts) change_[entry.slot] = 0;
  for (const auto& entry : resolved.erases) {
    change_[entry.slot] = 0;
    slots_.release(entry.op->object);
  }
}

/// Writes the new intervals on `axis` over the old ones; the interval list keeps the old order.
template <class Scalar, int Dim>
void ClassicSap<Scalar, Dim>::write_axis(int axis, const Ops& ops) {
  for (const auto* entries : {&ops.inserts, &ops.updates}) {
    for (const auto& [slot, op] : *entries) {
      boxes_[slot].min[axis] = op->box.min[axis];
      boxes_[slot].max[axis] = op->box.max[axis];
    }
  }
  const auto min_of = [&](Slot slot) { return Key::min_of(slot, boxes_[slot].min[axis]); };
  const auto max_of = [&](Slot slot) { return Key::max_of(slot, boxes_[slot].max[axis]); };
  std::vector<Key>& list = lists_[axis];
  for (Key& key : list) key = key.is_max() ? max_of(key.owner()) : min_of(key.owner());
  for (const auto& entry : ops.inserts) {
    list.push_back(min_of(entry.slot));
    list.push_back(max_of(entry.slot));
  }
}

template <class Scalar, int Dim>
template <class Precedes>
void ClassicSap<Scalar, Dim>::sort(int axis, Precedes precedes, DeltaList& deltas, SapCounters& counters) {
  std::vector<Key>& list = lists_[axis];
  counters.endpoints_visited += list.size();
  for (std::size_t from = 1; from < list.size(); ++from) {
    const Key key = list[from];
    std::size_t to = from;
    for (; to > 0 && precedes(key, list[to - 1]); --to) {
      swapped(axis, key, list[to - 1], deltas, counters);
      list[to] = list[to - 1];
    }
    list[to] = key;
  }
}

template <class Scalar, int Dim>
void ClassicSap<Scalar, Dim>::swapped(int axis, Key to_left, Key to_right, DeltaList& deltas,
                                      SapCounters& counters) const {
  ++counters.swaps;
  // The owners differ: a box's own min precedes its max before and after the sort, so the two never swap.
  if (to_left.is_max() == to_right.is_max()) return;
  // An erased object's swaps speak on the first axis alone, where all other axes are old, and an inserted one's on the
  // last, where they are new. In one dimension the two still sum to nothing for an erased and an inserted object.
  const int silent = (axis == Dim - 1 ? 0 : kInserted) | (axis == 0 ? 0 : kErased);
  const Slot left = to_left.owner();
  const Slot right = to_right.owner();
  if (((change_[left] | change_[right]) & silent) != 0) return;
  ++counters.box_tests;
  if (!boxes_[left].overlaps_beside(axis, boxes_[right])) return;
  ++counters.deltas;
  deltas.push_back({PairKey(slots_.object(left), slots_.object(right)), to_left.is_max() ? -1 : 1});
}

/// The order of endpoints with erased objects behind all others, and one behind the other so that none overlap.
template <class Scalar, int Dim>
bool ClassicSap<Scalar, Dim>::erased_last(Key a, Key b) const {
  const bool a_erased = change_[a.owner()] == kErased;
  const bool b_erased = change_[b.owner()] == kErased;
  if (a_erased != b_erased) return b_erased;
  if (a_erased && a.owner() != b.owner()) return a.owner() < b.owner();
  return a < b;
}

template <class Scalar, int Dim>
std::size_t ClassicSap<Scalar, Dim>::bytes() const {
  std::size_t bytes = sizeof(*this) + slots_.bytes() + boxes_.capacity() * sizeof(boxes_[0]) + change_.capacity();
  for (const std::vector<Key>& list : lists_) bytes += list.capacity() * sizeof(Key);
  return bytes;
}

template <class Scalar, int Dim>
void ClassicSap<Scalar, Dim>::append_residents(std::vector<Resident>& residents) const {
  for (Slot slot = 0; slot < slots_.slot_bound(); ++slot) {
    if (slots_.object(slot) != kNoObject) residents.push_back({slots_.object(slot), boxes_[slot]});
  }
}

template <class Scalar, int Dim>
void ClassicSap<Scalar, Dim>::validate() const {
  for (int axis = 0; axis < Dim; ++axis) validate_axis(axis);
}

template <class Scalar, int Dim>
void ClassicSap<Scalar, Dim>::validate_axis(int axis) const {
  const std::vector<Key>& list = lists_[axis];
  const auto at = [axis](std::size_t index) {
    return " at endpoint " + std::to_string(index) + " of axis " + std::to_string(axis);
  };
  for (std::size_t index = 1; index < list.size(); ++index) {
    require_invariant(list[index - 1] < list[index], "S1", [&] { return "endpoints out of order" + at(index); });
  }
  std::vector<char> sides(slots_.slot_bound(), 0);  // endpoints seen of each slot
  for (std::size_t index = 0; index < list.size(); ++index) {
    const Key key = list[index];
    const Slot owner = key.owner();
    require_invariant(owner < sides.size() && slots_.object(owner) != kNoObject, "S2",
                      [&] { return "no owner" + at(index); });
    require_invariant(sides[owner]++ == (key.is_max() ? 1 : 0), "S2",
                      [&] { return "wrong side of object " + std::to_string(slots_.object(owner)) + at(index); });
    require_invariant(key.value() == (key.is_max() ? boxes_[owner].max[axis] : boxes_[owner].min[axis]), "S2", [&] {
      return "not the box's value of object " + std::to_string(slots_.object(owner)) + at(index);
    });
  }
  require_invariant(list.size() == 2 * slots_.size(), "S2",
                    [&] { return "endpoints missing on axis " + std::to_string(axis); });
}

}  // namespace sweepgrid
