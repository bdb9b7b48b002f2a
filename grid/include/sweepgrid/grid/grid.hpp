#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <sweepgrid/grid/cell_range.hpp>
#include <sweepgrid/grid/grid_spec.hpp>
#include <sweepgrid/grid/op_queues.hpp>
#include <sweepgrid/sap/cell_kind.hpp>
#include <sweepgrid/sap/overlap_delta.hpp>
#include <sweepgrid/sap/sap_counters.hpp>

namespace sweepgrid {

/// The superstructure of section 3.1: cells, each a sweep and prune over its part of space, and who must hear of which
/// box. A box lives in every cell of its range; the client keeps the range beside the object.
///
/// A step is three calls: route_* for every op, gather for every group, drain for every active cell. No threads here:
/// calls for different blocks (route), groups (gather) and cells (drain) may run at once.
template <class Scalar, int Dim>
class Grid {
 public:
  using Op = CellOp<Scalar, Dim>;
  using BoxType = Box<Scalar, Dim>;

  /// A cell with queued ops (section 3.3), and what draining it is estimated to cost.
  struct ActiveCell {
    CellIndex cell;
    std::uint32_t first_op;  // among the group's ops
    std::uint32_t op_count;
    std::uint32_t population;
  };

  /// Drops all cells.
  void reset(const GridSpec<Scalar, Dim>& spec, const CellOptions& options);
  [[nodiscard]] const GridSpec<Scalar, Dim>& spec() const { return spec_; }

  /// Empties the queues (G2) and sets how finely routing and gathering are cut. `groups`: a power of two.
  void begin_step(std::size_t blocks, std::size_t groups);

  /// Queue an op to the cells that must hear of it and set or use the object's `range`.
  void route_insert(std::size_t block, ObjectId object, const BoxType& box, CellRange<Dim>& range);
  /// Returns whether the range changed (a migration: erases, inserts and updates in the cells concerned).
  bool route_update(std::size_t block, ObjectId object, const BoxType& box, CellRange<Dim>& range);
  void route_erase(std::size_t block, ObjectId object, const CellRange<Dim>& range);

  /// Sorts the group's ops by cell and lists its active cells, in cell order.
  void gather(std::size_t group);
  [[nodiscard]] std::span<const ActiveCell> active(std::size_t group) const { return groups_[group].active; }
  [[nodiscard]] std::size_t groups() const { return groups_.size(); }

  /// Applies a cell's ops; see SweepAndPrune::drain. A cell is created by its first insert and dropped when empty.
  void drain(std::size_t group, const ActiveCell& active, std::vector<OverlapDelta>& deltas, SapCounters& counters);

  /// Fetches what draining the cell will touch into the cache. `next`: the cell after it, whose turn to be fetched is
  /// next.
  void prefetch(const ActiveCell& active, const ActiveCell& next) const;

  /// The cell's sweep and prune, null where the cell is empty.
  [[nodiscard]] const SweepAndPrune<Scalar, Dim>* cell(CellIndex index) const { return cells_[index].get(); }

  /// Heap bytes of the cells, and of the queues.
  [[nodiscard]] std::size_t cell_bytes() const;
  [[nodiscard]] std::size_t queue_bytes() const;

 private:
  /// The queues of the cells of one group, one after another.
  struct Group {
    std::vector<Op> ops;
    std::vector<ActiveCell> active;
  };

  template <class Visit>
  void for_each_cell(const CellRange<Dim>& range, Visit&& visit) const;

  GridSpec<Scalar, Dim> spec_;
  CellOptions options_;
  std::vector<std::unique_ptr<SweepAndPrune<Scalar, Dim>>> cells_;  // by cell index; null when empty
  std::vector<std::uint32_t> queue_;  // by cell index; scratch of gather, all 0 outside it
  OpQueues<Scalar, Dim> queues_;
  std::vector<Group> groups_;
};

}  // namespace sweepgrid
