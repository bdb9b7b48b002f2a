#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <sweepgrid/sap/invariant.hpp>
#include <sweepgrid/sap/prefetch.hpp>
#include <sweepgrid/sap/refused_op.hpp>
#include <sweepgrid/sap/row_block.hpp>
#include <sweepgrid/sap/row_kernels.hpp>
#include <sweepgrid/sap/row_scalars.hpp>
#include <sweepgrid/sap/sweep_and_prune.hpp>

namespace sweepgrid {

/// The cell for few objects: rows of ids, mins and maxes, compared with vector instructions. Nothing is sorted; every
/// op is compared with all residents, O(m n) for m ops among n objects, and for few objects that is the least work.
/// With up to four axes, each pair that a drain changes gives exactly one delta. 24 bytes and one allocation; movable.
template <class Scalar, int Dim>
class RowCell final : public SweepAndPrune<Scalar, Dim> {
 public:
  using Base = SweepAndPrune<Scalar, Dim>;
  using typename Base::Op;
  using typename Base::Resident;
  using typename Base::Visit;

  void drain(std::span<const Op> ops, DeltaList& deltas, SapCounters& counters) override {
    if (ops.empty()) return;
    const std::size_t done = Kernels::drain(rows_, typename Kernels::Ops(ops), deltas, counters);
    if (done != ops.size()) refuse_op(ops[done]);
  }

  /// Memory for refresh(), to be used again for other cells.
  struct RefreshScratch {
    std::vector<OrderedBox<Scalar, Dim>> boxes;
    std::vector<std::uint32_t> moved;
  };

  /// Asks for the boxes of all residents: `boxes` tells whether one has changed(object), and the box after(object) that
  /// it has now. The same as a drain() of an update for each that has changed, but nobody has to be looked up. Returns
  /// how many have. `visits` are of objects that come by meanwhile: each pair of theirs that changes gives one delta,
  /// whoever of the two has moved.
  template <class Boxes>
  std::size_t refresh(const Boxes& boxes, RefreshScratch& scratch, DeltaList& deltas, SapCounters& counters,
                      std::span<const Visit> visits = {});

  void visit(std::span<const Visit> visits, DeltaList& deltas, SapCounters& counters) const override {
    if (visits.empty() || rows_.size() == 0) return;
    Kernels::visit(rows_, nullptr, typename Kernels::Visits(visits), deltas, counters);
  }

  void transfer(std::span<const Op> ops, SapCounters& /*counters*/) override {
    if (ops.empty()) return;
    const std::size_t done = Kernels::transfer(rows_, typename Kernels::Ops(ops));
    if (done != ops.size()) refuse_op(ops[done]);
  }

  /// Has these objects and no others, and keeps the memory that it has.
  void refill(std::span<const Op> ops) {
    rows_.clear();
    rows_.reserve(ops.size());
    for (const Op& op : ops) {
      const std::uint32_t place = rows_.append(op.object);
      for (int axis = 0; axis < Dim; ++axis) {
        rows_.set_bits(axis, place, op.box.min[axis]);
        rows_.set_bits(Dim + axis, place, op.box.max[axis]);
      }
    }
  }

  /// The residents, by place.
  [[nodiscard]] std::span<const ObjectId> ids() const { return {rows_.ids(), rows_.size()}; }

  [[gnu::always_inline]] void prefetch() const override { sweepgrid::prefetch(rows_.data(), rows_.bytes()); }
  [[nodiscard]] std::size_t size() const override { return rows_.size(); }
  [[nodiscard]] std::size_t bytes() const override { return rows_.bytes(); }
  void append_residents(std::vector<Resident>& residents) const override;

  /// S5: each object has one place, and there a box whose mins are not above its maxes.
  void validate() const override;

 private:
  using Bits = OrderedBits<Scalar>;
  using Kernels = std::conditional_t<RowKernels<Bits, Dim>::kCompiled, RowKernels<Bits, Dim>, RowScalars<Bits, Dim>>;

  RowBlock<Bits, Dim> rows_;
};

template <class Scalar, int Dim>
template <class Boxes>
std::size_t RowCell<Scalar, Dim>::refresh(const Boxes& boxes, RefreshScratch& scratch, DeltaList& deltas,
                                          SapCounters& counters, std::span<const Visit> visits) {
  const std::uint32_t size = rows_.size();
  if (size == 0) return 0;
  if (scratch.moved.size() < size) scratch.moved.resize(size), scratch.boxes.resize(size);
  const ObjectId* const ids = rows_.ids();
  OrderedBox<Scalar, Dim>* const now = scratch.boxes.data();
  std::uint32_t* const moved = scratch.moved.data();
  std::uint32_t count = 0;
  for (std::uint32_t place = 0; place < size; ++place) {
    now[place] = OrderedBox<Scalar, Dim>(boxes.after(ids[place]));
    moved[count] = place;
    count += boxes.changed(ids[place]) ? 1 : 0;  // no branch on what cannot be foretold
  }
  static_assert(sizeof(*now) == 2 * Dim * sizeof(Bits));
  const Bits* const bits = now->min.data();
  if (!visits.empty()) {
    Kernels::visit(rows_, count != 0 ? bits : nullptr, typename Kernels::Visits(visits), deltas, counters);
  }
  if (count != 0) Kernels::refresh(rows_, bits, {moved, count}, deltas, counters);
  return count;
}

template <class Scalar, int Dim>
void RowCell<Scalar, Dim>::append_residents(std::vector<Resident>& residents) const {
  for (std::uint32_t place = 0; place < rows_.size(); ++place) {
    Resident& resident = residents.emplace_back();
    resident.object = rows_.ids()[place];
    for (int axis = 0; axis < Dim; ++axis) {
      resident.box.min[axis] = rows_.bits(axis, place);
      resident.box.max[axis] = rows_.bits(Dim + axis, place);
    }
  }
}

template <class Scalar, int Dim>
void RowCell<Scalar, Dim>::validate() const {
  std::vector<ObjectId> ids(rows_.ids(), rows_.ids() + rows_.size());
  std::sort(ids.begin(), ids.end());
  const auto twin = std::adjacent_find(ids.begin(), ids.end());
  require_invariant(twin == ids.end(), "S5", [&] { return "object " + std::to_string(*twin) + " has two places"; });
  for (std::uint32_t place = 0; place < rows_.size(); ++place) {
    for (int axis = 0; axis < Dim; ++axis) {
      require_invariant(rows_.bits(axis, place) <= rows_.bits(Dim + axis, place), "S5", [&] {
        return "object " + std::to_string(rows_.ids()[place]) + " has a min above its max on axis " +
               std::to_string(axis);
      });
    }
  }
}

}  // namespace sweepgrid
