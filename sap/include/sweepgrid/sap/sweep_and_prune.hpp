#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <sweepgrid/sap/cell_op.hpp>
#include <sweepgrid/sap/delta_list.hpp>
#include <sweepgrid/sap/sap_counters.hpp>

namespace sweepgrid {

/// What every kind of cell does: boxes in, exact overlap deltas out. One virtual call per cell and step.
///
/// Not thread-safe: a cell is drained by one worker at a time. Different cells share nothing.
template <class Scalar, int Dim>
class SweepAndPrune {
 public:
  using Op = CellOp<Scalar, Dim>;

  /// One resident as validate() and tests see it.
  struct Resident {
    ObjectId object = kNoObject;
    OrderedBox<Scalar, Dim> box;
  };

  /// An object that is no resident comes by: its box was `before` (if it `was` there) and is `after` (if it still
  /// `is`).
  struct Visit {
    ObjectId object = kNoObject;
    bool was = false;
    bool is = false;
    OrderedBox<Scalar, Dim> before;
    OrderedBox<Scalar, Dim> after;
  };

  virtual ~SweepAndPrune() = default;

  /// Applies `ops` and appends to `deltas` how the set of overlapping pairs changed: for each pair, the sum of its
  /// deltas is its state after minus its state before. The order of `ops` and of `deltas` means nothing.
  /// Precondition: at most one op per object; an insert names an absent object, an update or erase a present one.
  /// An op that breaks the second rule throws std::invalid_argument that names the object, and nothing is applied.
  virtual void drain(std::span<const Op> ops, DeltaList& deltas, SapCounters& counters) = 0;

  /// Appends how the overlap of each visitor with each resident changes. Residents stay as they are, visitors are not
  /// compared with each other, and nothing is kept. Each changed pair gives one delta.
  /// Precondition: no visitor is a resident.
  virtual void visit(std::span<const Visit> visits, DeltaList& deltas, SapCounters& counters) const;

  /// What visit() does, among residents as given.
  static void visit(std::span<const Resident> residents, std::span<const Visit> visits, DeltaList& deltas,
                    SapCounters& counters);

  /// Inserts and erases as drain() does, with the same refusals, but reports no deltas: for objects whose pairs are
  /// known elsewhere already. Precondition: that of drain(), and no op is an update.
  virtual void transfer(std::span<const Op> ops, SapCounters& counters);

  /// Fetches what the next drain() will touch into the cache, while another cell is drained. Does nothing else.
  virtual void prefetch() const {}

  [[nodiscard]] virtual std::size_t size() const = 0;

  /// Heap bytes held, unused capacity included.
  [[nodiscard]] virtual std::size_t bytes() const = 0;

  /// Appends every object with its box, in no order.
  virtual void append_residents(std::vector<Resident>& residents) const = 0;

  /// Checks the invariants S1 to S3 and S5 as far as they apply to the kind; throws InvariantError. O(n log n).
  virtual void validate() const = 0;
};

template <class Scalar, int Dim>
void SweepAndPrune<Scalar, Dim>::visit(std::span<const Visit> visits, DeltaList& deltas, SapCounters& counters) const {
  if (visits.empty()) return;
  std::vector<Resident> residents;
  append_residents(residents);
  visit(residents, visits, deltas, counters);
}

template <class Scalar, int Dim>
void SweepAndPrune<Scalar, Dim>::visit(std::span<const Resident> residents, std::span<const Visit> visits,
                                       DeltaList& deltas, SapCounters& counters) {
  const std::size_t known = deltas.size();
  for (const Visit& visit : visits) {
    counters.box_tests += residents.size() * (std::size_t{visit.was} + std::size_t{visit.is});
    for (const Resident& resident : residents) {
      const bool was = visit.was && visit.before.overlaps(resident.box);
      const bool is = visit.is && visit.after.overlaps(resident.box);
      if (was != is) deltas.push_back({PairKey(visit.object, resident.object), is ? +1 : -1});
    }
  }
  counters.deltas += deltas.size() - known;
}

template <class Scalar, int Dim>
void SweepAndPrune<Scalar, Dim>::transfer(std::span<const Op> ops, SapCounters& counters) {
  DeltaList unwanted;
  drain(ops, unwanted, counters);
  counters.deltas -= unwanted.size();
}

}  // namespace sweepgrid
