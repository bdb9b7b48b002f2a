#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <sweepgrid/sap/cell_op.hpp>
#include <sweepgrid/sap/overlap_delta.hpp>
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

  virtual ~SweepAndPrune() = default;

  /// Applies `ops` and appends to `deltas` how the set of overlapping pairs changed: for each pair, the sum of its
  /// deltas is its state after minus its state before. The order of `ops` and of `deltas` means nothing.
  /// Precondition: at most one op per object; an insert names an absent object, an update or erase a present one.
  /// An op that breaks the second rule throws std::invalid_argument that names the object, and nothing is applied.
  virtual void drain(std::span<const Op> ops, std::vector<OverlapDelta>& deltas, SapCounters& counters) = 0;

  /// Fetches what the next drain() will touch into the cache, while another cell is drained. Does nothing else.
  virtual void prefetch() const {}

  [[nodiscard]] virtual std::size_t size() const = 0;

  /// Heap bytes held, unused capacity included.
  [[nodiscard]] virtual std::size_t bytes() const = 0;

  /// Appends every object with its box, in no order.
  virtual void append_residents(std::vector<Resident>& residents) const = 0;

  /// Checks the invariants S1 to S3 as far as they apply to the kind; throws InvariantError. O(n log n).
  virtual void validate() const = 0;
};

}  // namespace sweepgrid
