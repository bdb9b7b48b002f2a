#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <sweepgrid/sap/endpoint.hpp>
#include <sweepgrid/sap/invariant.hpp>
#include <sweepgrid/sap/object_slots.hpp>
#include <sweepgrid/sap/resolved_ops.hpp>
#include <sweepgrid/sap/sweep_and_prune.hpp>

namespace sweepgrid {

/// The non-incremental sweeping plane (paper, section 2): every drain with ops sorts the endpoints of one axis anew,
/// sweeps them and compares the pairs it finds with those of the drain before. O(n log n + pairs that meet on that
/// axis) however little moved: a baseline, and the one kind that keeps its overlapping pairs.
template <class Scalar, int Dim>
class SweepingPlane final : public SweepAndPrune<Scalar, Dim> {
 public:
  using typename SweepAndPrune<Scalar, Dim>::Op;
  using typename SweepAndPrune<Scalar, Dim>::Resident;

  void drain(std::span<const Op> ops, DeltaList& deltas, SapCounters& counters) override;
  [[nodiscard]] std::size_t size() const override { return slots_.size(); }
  [[nodiscard]] std::size_t bytes() const override {
    return sizeof(*this) + slots_.bytes() + boxes_.capacity() * sizeof(boxes_[0]) +
           overlaps_.capacity() * sizeof(PairKey);
  }
  void append_residents(std::vector<Resident>& residents) const override;

  /// S4, by a sweep along another axis where there is one. No interval list outlives a drain, so S1 and S2 say nothing.
  void validate() const override;

 private:
  [[nodiscard]] std::vector<Endpoint<Scalar>> sorted_endpoints(int axis) const;
  [[nodiscard]] std::vector<PairKey> sweep(int axis, SapCounters& counters) const;

  ObjectSlots slots_;
  std::vector<OrderedBox<Scalar, Dim>> boxes_;  // by slot
  std::vector<PairKey> overlaps_;               // after the last drain; sorted, unique
};

template <class Scalar, int Dim>
void SweepingPlane<Scalar, Dim>::drain(std::span<const Op> ops, DeltaList& deltas, SapCounters& counters) {
  DrainArena arena(deltas);
  const ResolvedOps<Scalar, Dim> resolved(ops, slots_, arena.resource());
  if (ops.empty()) return;
  ++counters.global_sorts;
  boxes_.resize(slots_.slot_bound());
  for (const auto& [slot, op] : resolved.inserts) boxes_[slot] = op->box;
  for (const auto& [slot, op] : resolved.updates) boxes_[slot] = op->box;
  for (const auto& [slot, op] : resolved.erases) slots_.release(op->object);
  std::vector<PairKey> overlaps = sweep(0, counters);
  const std::size_t known = deltas.size();
  const auto append_missing = [&deltas](const std::vector<PairKey>& from, const std::vector<PairKey>& in, int change) {
    std::vector<PairKey> missing;
    std::set_difference(from.begin(), from.end(), in.begin(), in.end(), std::back_inserter(missing));
    for (const PairKey pair : missing) deltas.push_back({pair, change});
  };
  append_missing(overlaps, overlaps_, +1);
  append_missing(overlaps_, overlaps, -1);
  counters.deltas += deltas.size() - known;
  overlaps_ = std::move(overlaps);
}

template <class Scalar, int Dim>
std::vector<Endpoint<Scalar>> SweepingPlane<Scalar, Dim>::sorted_endpoints(int axis) const {
  std::vector<Endpoint<Scalar>> endpoints;
  endpoints.reserve(2 * size());
  for (Slot slot = 0; slot < slots_.slot_bound(); ++slot) {
    if (slots_.object(slot) == kNoObject) continue;
    endpoints.push_back(Endpoint<Scalar>::min_of(slot, boxes_[slot].min[axis]));
    endpoints.push_back(Endpoint<Scalar>::max_of(slot, boxes_[slot].max[axis]));
  }
  std::sort(endpoints.begin(), endpoints.end());
  return endpoints;
}

/// All overlapping pairs, sorted. The sweep set holds the boxes that the plane cuts, so that it is enough to test each
/// box against those that are cut when the plane first meets it, on the other axes.
template <class Scalar, int Dim>
std::vector<PairKey> SweepingPlane<Scalar, Dim>::sweep(int axis, SapCounters& counters) const {
  std::vector<PairKey> pairs;
  std::vector<Slot> sweep_set;
  std::vector<std::size_t> position(slots_.slot_bound());  // in the sweep set, by slot
  counters.endpoints_visited += 2 * size();
  counters.endpoints_sorted += 2 * size();
  for (const Endpoint<Scalar> endpoint : sorted_endpoints(axis)) {
    const Slot slot = endpoint.owner();
    if (endpoint.is_max()) {
      position[sweep_set.back()] = position[slot];
      sweep_set[position[slot]] = sweep_set.back();
      sweep_set.pop_back();
      continue;
    }
    counters.box_tests += sweep_set.size();
    for (const Slot other : sweep_set) {
      if (!boxes_[slot].overlaps_beside(axis, boxes_[other])) continue;
      pairs.emplace_back(slots_.object(slot), slots_.object(other));
    }
    position[slot] = sweep_set.size();
    sweep_set.push_back(slot);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

template <class Scalar, int Dim>
void SweepingPlane<Scalar, Dim>::append_residents(std::vector<Resident>& residents) const {
  for (Slot slot = 0; slot < slots_.slot_bound(); ++slot) {
    if (slots_.object(slot) != kNoObject) residents.push_back({slots_.object(slot), boxes_[slot]});
  }
}

template <class Scalar, int Dim>
void SweepingPlane<Scalar, Dim>::validate() const {
  SapCounters ignored;
  const std::vector<PairKey> expected = sweep(Dim - 1, ignored);
  const auto [kept, truth] = std::mismatch(overlaps_.begin(), overlaps_.end(), expected.begin(), expected.end());
  if (kept == overlaps_.end() && truth == expected.end()) return;
  const bool extra = truth == expected.end() || (kept != overlaps_.end() && *kept < *truth);
  const PairKey pair = extra ? *kept : *truth;
  throw InvariantError("S4", "objects " + std::to_string(pair.lower()) + " and " + std::to_string(pair.upper()) +
                                 (extra ? " are kept as overlapping but do not" : " overlap but are not kept"));
}

}  // namespace sweepgrid
