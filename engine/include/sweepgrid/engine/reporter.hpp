#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <sweepgrid/engine/object_table.hpp>
#include <sweepgrid/grid/levels.hpp>
#include <sweepgrid/sap/ids.hpp>
#include <sweepgrid/sap/prefetch.hpp>

namespace sweepgrid {

/// The boxes of the running step, at its start and at its end, as grids ask for them.
template <class Scalar, int Dim>
class StepBoxes {
 public:
  using Objects = ObjectTable<Scalar, Dim>;
  using BoxType = Box<Scalar, Dim>;

  StepBoxes(const Objects& objects, std::uint64_t step) : objects_(objects), step_(step) {}

  [[nodiscard]] bool changed(ObjectId object) const { return objects_.record(object).changed_at == step_; }
  [[nodiscard]] const BoxType& before(ObjectId object) const {
    const auto& record = objects_.record(object);
    return record.changed_at == step_ ? record.before : record.box;
  }
  [[nodiscard]] const BoxType& after(ObjectId object) const { return objects_.record(object).box; }
  // Forced inline: g++ 12 takes a function that only prefetches for one without effect, and drops its calls.
  [[gnu::always_inline]] void prefetch(ObjectId object) const { sweepgrid::prefetch(&objects_.record(object)); }

 private:
  const Objects& objects_;
  std::uint64_t step_;
};

enum class Verdict : std::uint8_t { kNothing, kBegin, kEnd };

/// Judges overlap deltas without a table of pairs. Whether a pair has begun or ended to overlap follows from its boxes
/// at the start and the end of the step; and of all cells that may see it, exactly one is to report it: the cell that
/// holds the lower corner of the intersection of the boxes (those at the end for a begin, at the start for an end).
///
/// Objects of one grid meet there. Objects of two grids meet in the cells of the coarser one if the finer object
/// changed in this step, and was shown there; else in the cells of the finer one, where the coarser object was shown.
template <class Scalar, int Dim>
class Reporter {
 public:
  using Objects = ObjectTable<Scalar, Dim>;
  using Record = typename Objects::Record;
  using BoxType = Box<Scalar, Dim>;

  Reporter(const Objects& objects, const Levels<Scalar, Dim>& levels, std::uint64_t step)
      : objects_(objects), levels_(levels), step_(step) {}

  /// What the cell with this code of this grid is to report of a pair for which it has a delta.
  [[nodiscard]] Verdict judge(PairKey pair, GridIndex grid, std::uint64_t cell) const {
    const Side a(objects_.record(pair.lower()), step_);
    const Side b(objects_.record(pair.upper()), step_);
    const bool was = a.was && b.was && overlap(*a.before, *b.before);
    const bool is = a.is && b.is && overlap(*a.after, *b.after);
    if (was == is) return Verdict::kNothing;
    const GridIndex grid_a = was ? a.grid_before : a.grid;
    const GridIndex grid_b = was ? b.grid_before : b.grid;
    if (grid != (grid_a == grid_b ? grid_a : meeting_grid(grid_a, a.changed, grid_b, b.changed))) {
      return Verdict::kNothing;
    }
    const auto& spec = levels_.grid(grid).spec();
    if (corner(was ? *a.before : *a.after, was ? *b.before : *b.after, spec) != cell) return Verdict::kNothing;
    return is ? Verdict::kBegin : Verdict::kEnd;
  }

  /// Code of the cell that holds the lower corner of the intersection of two boxes.
  [[nodiscard]] static std::uint64_t corner(const BoxType& a, const BoxType& b, const GridSpec<Scalar, Dim>& spec) {
    std::uint64_t code = 0;
    for (int axis = 0; axis < Dim; ++axis) {
      code |= CellCode<Dim>::part(axis, spec.coordinate(axis, std::max(a.min[axis], b.min[axis])));
    }
    return code;
  }

  [[gnu::always_inline]] void prefetch(PairKey pair) const {
    __builtin_prefetch(&objects_.record(pair.lower()));
    __builtin_prefetch(&objects_.record(pair.upper()));
  }

 private:
  struct Side {
    Side(const Record& record, std::uint64_t step)
        : changed(record.changed_at == step),
          was(!changed || (record.change & Objects::kInserted) == 0),
          is(!changed || (record.change & Objects::kErased) == 0),
          grid(record.grid),
          grid_before(changed ? record.grid_before : record.grid),
          before(changed ? &record.before : &record.box),
          after(&record.box) {}

    bool changed, was, is;
    GridIndex grid, grid_before;
    const BoxType* before;
    const BoxType* after;
  };

  // As cells compare: by ordered bits, which tell denormals apart where the host flushes them to zero.
  [[nodiscard]] static bool overlap(const BoxType& a, const BoxType& b) {
    return OrderedBox<Scalar, Dim>(a).overlaps(OrderedBox<Scalar, Dim>(b));
  }

  [[nodiscard]] GridIndex meeting_grid(GridIndex a, bool a_changed, GridIndex b, bool b_changed) const {
    const bool b_coarser = levels_.coarser(b, a);
    const bool finer_changed = b_coarser ? a_changed : b_changed;
    return finer_changed == b_coarser ? b : a;
  }

  const Objects& objects_;
  const Levels<Scalar, Dim>& levels_;
  std::uint64_t step_;
};

}  // namespace sweepgrid
