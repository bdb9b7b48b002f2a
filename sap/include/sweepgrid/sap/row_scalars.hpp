#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <sweepgrid/sap/delta_list.hpp>
#include <sweepgrid/sap/row_block.hpp>
#include <sweepgrid/sap/row_views.hpp>
#include <sweepgrid/sap/sap_counters.hpp>

namespace sweepgrid {

/// RowKernels without vectors and one op after another, for numbers of axes that none are compiled for.
template <class Bits, int Dim>
class RowScalars {
 public:
  using Block = RowBlock<Bits, Dim>;
  using Ops = OpViews<Bits, Dim>;
  using Visits = VisitViews<Bits, Dim>;

  static std::size_t drain(Block& block, Ops ops, DeltaList& deltas, SapCounters& counters) {
    const std::size_t deltas_before = deltas.size();
    const std::size_t done =
        apply(block, ops, [&](ObjectId object, std::uint32_t own, const Bits* from, const Bits* to) {
          compare(block, object, own, from, to, deltas, counters);
        });
    counters.deltas += deltas.size() - deltas_before;
    return done;
  }

  static std::size_t transfer(Block& block, Ops ops) {
    return apply(block, ops, [](ObjectId, std::uint32_t, const Bits*, const Bits*) {});
  }

  static void refresh(Block& block, const Bits* boxes, std::span<const std::uint32_t> moved, DeltaList& deltas,
                      SapCounters& counters) {
    const std::size_t deltas_before = deltas.size();
    for (const std::uint32_t place : moved) {
      const Bits* const to = boxes + std::size_t{place} * (2 * Dim);
      Bits from[2 * Dim];
      for (int row = 0; row < 2 * Dim; ++row) from[row] = block.bits(row, place);
      compare(block, block.ids()[place], place, from, to, deltas, counters);
      for (int row = 0; row < 2 * Dim; ++row) block.set_bits(row, place, to[row]);
    }
    counters.deltas += deltas.size() - deltas_before;
  }

  static void visit(const Block& block, const Bits* boxes, Visits visits, DeltaList& deltas, SapCounters& counters) {
    const std::size_t deltas_before = deltas.size();
    for (std::size_t index = 0; index < visits.size(); ++index) {
      const auto visit = visits[index];
      for (std::uint32_t place = 0; place < block.size(); ++place) {
        const Bits* const now = boxes == nullptr ? nullptr : boxes + std::size_t{place} * (2 * Dim);
        const bool was = visit.was() && overlap(block, place, visit.before());
        const bool is =
            visit.is() && (now == nullptr ? overlap(block, place, visit.after()) : overlap(now, visit.after()));
        counters.box_tests += (visit.was() ? 1 : 0) + (visit.is() ? 1 : 0);
        if (was != is) deltas.push_back({PairKey(visit.object(), block.ids()[place]), is ? +1 : -1});
      }
    }
    counters.deltas += deltas.size() - deltas_before;
  }

 private:
  static std::uint32_t place_of(const Block& block, ObjectId object) {
    return static_cast<std::uint32_t>(std::find(block.ids(), block.ids() + block.size(), object) - block.ids());
  }

  /// Calls `changing` with an object, its place, its old box and its new box (nullptr: none) before each change.
  template <class Changing>
  static std::size_t apply(Block& block, Ops ops, const Changing& changing) {
    for (std::size_t index = 0; index < ops.size(); ++index) {
      const bool absent = place_of(block, ops[index].object()) == block.size();
      if (absent != (ops[index].kind() == OpKind::kInsert)) return index;
    }
    for (std::size_t index = 0; index < ops.size(); ++index) {
      const auto op = ops[index];
      const std::uint32_t place = place_of(block, op.object());
      Bits old_box[2 * Dim];
      for (int row = 0; row < 2 * Dim && op.kind() != OpKind::kInsert; ++row) old_box[row] = block.bits(row, place);
      changing(op.object(), place, op.kind() == OpKind::kInsert ? nullptr : old_box,
               op.kind() == OpKind::kErase ? nullptr : op.box());
      if (op.kind() == OpKind::kErase) {
        block.remove(place);
        continue;
      }
      block.reserve(std::uint64_t{place} + 1);
      if (op.kind() == OpKind::kInsert) block.append(op.object());
      for (int row = 0; row < 2 * Dim; ++row) block.set_bits(row, place, op.box()[row]);
    }
    block.fit();
    return ops.size();
  }

  static bool overlap(const Block& block, std::uint32_t place, const Bits* box) {
    for (int axis = 0; axis < Dim; ++axis) {
      if (block.bits(axis, place) > box[Dim + axis] || box[axis] > block.bits(Dim + axis, place)) return false;
    }
    return true;
  }

  static bool overlap(const Bits* a, const Bits* b) {
    for (int axis = 0; axis < Dim; ++axis) {
      if (a[axis] > b[Dim + axis] || b[axis] > a[Dim + axis]) return false;
    }
    return true;
  }

  static void compare(const Block& block, ObjectId object, std::uint32_t own, const Bits* from, const Bits* to,
                      DeltaList& deltas, SapCounters& counters) {
    for (std::uint32_t place = 0; place < block.size(); ++place) {
      if (place == own) continue;
      counters.box_tests += (from != nullptr ? 1 : 0) + (to != nullptr ? 1 : 0);
      const bool was = from != nullptr && overlap(block, place, from);
      const bool is = to != nullptr && overlap(block, place, to);
      if (was != is) deltas.push_back({PairKey(object, block.ids()[place]), is ? +1 : -1});
    }
  }
};

}  // namespace sweepgrid
