#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <sweepgrid/grid/cell.hpp>
#include <sweepgrid/grid/cell_directory.hpp>
#include <sweepgrid/grid/grid_spec.hpp>
#include <sweepgrid/grid/op_queues.hpp>
#include <sweepgrid/sap/step_budget.hpp>

namespace sweepgrid {

/// What the drain of some cells leaves behind, and its scratch memory.
template <class Scalar, int Dim>
struct DrainOutput {
  /// The deltas of one cell end at `end` of `deltas`; those of the cell before it end where they begin.
  struct Run {
    std::size_t end;
    std::uint64_t cell;  // code
  };

  DeltaList deltas;
  std::vector<Run> runs;
  std::vector<std::uint32_t> emptied;  // ids of cells that are empty now
  SapCounters counters;

  std::vector<CellOp<Scalar, Dim>> ops;
  std::vector<typename SweepAndPrune<Scalar, Dim>::Resident> residents;
  typename RowCell<Scalar, Dim>::RefreshScratch refresh;
  std::vector<typename SweepAndPrune<Scalar, Dim>::Visit> visits;
  std::vector<typename SweepAndPrune<Scalar, Dim>::Visit> sides;
  std::vector<CellOp<Scalar, Dim>> passing;
  RowCell<Scalar, Dim> passing_rows;

  void clear() {
    deltas.clear();
    runs.clear();
    most_emptied_.release(emptied);
    counters = SapCounters{};
  }

  /// A cell is drained of so many calls and residents.
  void note_cell(std::size_t calls, std::size_t population) { in_cell_ = std::max(in_cell_, calls + population); }
  /// Ends a step: what is told of it is forgotten but for emptied cells and counters, and memory beyond what HighWater
  /// allows goes back.
  void note_step() {
    deltas.note_step();
    most_runs_.recycle(runs);
    most_emptied_.note(emptied.size());
    most_in_cell_.note(std::exchange(in_cell_, 0));
    release_scratch();
  }
  /// As note_step() for so many steps in which nothing was drained.
  void pass(std::size_t steps) {
    clear();
    deltas.pass(steps);
    most_runs_.pass(steps);
    most_runs_.release(runs);
    most_emptied_.pass(steps);
    most_emptied_.release(emptied);
    most_in_cell_.pass(steps);
    release_scratch();
  }

  /// Heap bytes held.
  [[nodiscard]] std::size_t bytes() const {
    const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    return deltas.bytes() + of(runs) + of(emptied) + of(ops) + of(residents) + of(refresh.boxes) + of(refresh.moved) +
           of(visits) + of(sides) + of(passing) + passing_rows.bytes();
  }

 private:
  // One number for all that is filled anew for each cell: none is longer than the cell's calls and residents.
  void release_scratch() {
    const auto release = [this](auto&... lists) { (most_in_cell_.release(lists), ...); };
    release(ops, residents, refresh.boxes, refresh.moved, visits, sides, passing);
    if (passing_rows.bytes() > most_in_cell_.allowed() * sizeof(CellOp<Scalar, Dim>)) passing_rows = {};
  }

  std::size_t in_cell_ = 0;
  HighWater most_runs_;
  HighWater most_emptied_;
  HighWater most_in_cell_;
};

/// The superstructure of section 3.1 with one cell size: cells that exist where objects are, and who must hear of which
/// box. A box lives in every cell of its range.
///
/// A step is three calls: route_* for every op, gather for every shard, drain for every active cell. No threads here:
/// calls for different blocks (route), shards (gather) and cells (drain) may run at once.
template <class Scalar, int Dim>
class Grid {
 public:
  using BoxType = Box<Scalar, Dim>;
  using CellType = Cell<Scalar, Dim>;
  using Range = CellRange<Dim>;
  using Output = DrainOutput<Scalar, Dim>;

  /// A cell with queued calls (section 3.3), and what draining it is estimated to cost.
  struct ActiveCell {
    std::uint32_t cell;  // id in the shard
    std::uint32_t first_call;
    std::uint32_t call_count;
    std::uint32_t population;
  };

  /// `shards`: how many parts may be gathered at once, a power of two.
  Grid(const GridSpec<Scalar, Dim>& spec, const CellOptions& options, std::size_t shards);

  [[nodiscard]] const GridSpec<Scalar, Dim>& spec() const { return spec_; }

  /// Sets in how many blocks ops arrive. `budget`: what calls are charged to, kCallBytes for each; null: nothing.
  void begin_step(std::size_t blocks, StepBudget* budget = nullptr);
  static constexpr std::uint64_t kCallBytes = 16;
  /// To be called after the last op of the block is routed.
  void end_block(std::size_t block) { look_up(block); }
  /// Calls that the block has queued. Precondition: end_block().
  [[nodiscard]] std::size_t calls(std::size_t block) const { return ops_.written(block) + late_.written(block); }

  void route_insert(std::size_t block, ObjectId object, const BoxType& box);
  /// Returns whether the cell range changed (a migration: erases, inserts and updates in the cells concerned).
  bool route_update(std::size_t block, ObjectId object, const BoxType& before, const BoxType& after);
  void route_erase(std::size_t block, ObjectId object, const BoxType& before);

  /// Shows an object of another grid that changed to the cells that it may concern. Null: it had no box, or has none.
  /// `resting_only`: only residents that rest in this step need to hear of it, so cells that both boxes cover wholly
  /// are left out, as nothing changes there, and cells that do not exist yet.
  void route_visit(std::size_t block, ObjectId object, const BoxType* before, const BoxType* after, bool resting_only);

  /// Sorts the shard's calls by cell, makes the cells that are missing, and lists the active cells.
  void gather(std::size_t shard);
  [[nodiscard]] std::span<const ActiveCell> active(std::size_t shard) const { return shards_[shard].active; }
  [[nodiscard]] std::size_t shards() const { return shards_.size(); }
  /// Applies the calls of active cells [first, last) of the shard. `boxes` tells each object's box at the start and at
  /// the end of the step: before(id), after(id), prefetch(id).
  template <class Boxes>
  void drain(std::size_t shard, std::span<const ActiveCell> cells, const Boxes& boxes, Output& out);

  /// In place of gather() and drain() for a grid without cells: takes in whom route_insert() named, without a word
  /// about pairs. `box_of(id)`: the box that route_insert() was given.
  template <class BoxOf>
  void fill(std::size_t shard, const BoxOf& box_of, Output& out);

  /// Drops those of the cells that are still empty. Not beside other calls.
  void drop_empty(std::size_t shard, std::span<const std::uint32_t> cells);
  /// Ends a step: memory that the latest 64 steps did not need goes back. `idle`: or so many steps in which nothing was
  /// queued. Not beside other calls; throws nothing.
  void note_step();
  void pass(std::size_t idle);

  /// Calls `visit` with every cell, in no order.
  template <class Visit>
  void for_each_cell(Visit&& visit) const;
  /// The cell with this code, or null.
  [[nodiscard]] const CellType* find(std::uint64_t code) const;
  [[nodiscard]] std::size_t cell_count() const;

  /// Heap bytes of the cells, and of the queues.
  [[nodiscard]] std::size_t cell_bytes() const;
  [[nodiscard]] std::size_t queue_bytes() const;

 private:
  using CellId = typename CellDirectory<Dim>::CellId;
  using Code = CellCode<Dim>;

  struct Call {
    ObjectId object;
    CellCall call;
  };

  struct Shard {
    CellDirectory<Dim> directory;
    std::vector<CellType> cells;  // by id
    std::vector<CellId> free;
    std::vector<std::uint32_t> queue;  // by id; scratch of gather, all 0 outside it
    std::vector<Call> calls;           // by cell
    std::vector<ActiveCell> active;
    std::size_t cells_used = 0;  // in this step, before those that are empty were dropped
    HighWater most_cells;
    HighWater most_calls;
    HighWater most_active;
  };

  [[nodiscard]] std::size_t shard_of(std::uint64_t code) const {
    return shards_.size() == 1 ? 0 : Code::hash(Code::block(code)) >> shard_shift_;
  }
  /// Calls of a block of objects whose cells are yet to be looked up: many in a row, so that one look-up does not wait
  /// for another, nor for branches that nobody could foresee.
  struct Waiting {
    static constexpr std::size_t kMost = 128;
    static constexpr std::size_t kCorners = Dim <= 3 ? std::size_t{1} << Dim : 1;
    std::array<OpQueues::Fresh, kMost + kCorners> calls;
    std::size_t count = 0;
  };
  void call(std::size_t block, std::uint64_t code, ObjectId object, CellCall call);
  void call_all(std::size_t block, const Range& range, ObjectId object, CellCall call);
  void look_up(std::size_t block);
  CellId locate(Shard& shard, const OpQueues::Fresh& op);
  CellId make_cell_at(Shard& shard, std::uint64_t code, CellId& place);
  static void release_cells(Shard& shard) noexcept;
  static void compact(Shard& shard);
  template <class Boxes>
  void drain_cell(Shard& shard, const ActiveCell& active, const Boxes& boxes, Output& out);
  template <class Boxes>
  static std::size_t take_ops(std::span<const Call> calls, const Boxes& boxes, Output& out);
  template <class Boxes>
  static void take_visits(std::span<const Call> calls, const Boxes& boxes, Output& out);
  template <class Boxes>
  void drain_visited(CellType& cell, std::span<const Call> calls, const Boxes& boxes, Output& out) const;
  template <class Boxes>
  static void refresh_visited(CellType& cell, const Boxes& boxes, Output& out);
  using Visits = std::vector<typename SweepAndPrune<Scalar, Dim>::Visit>;
  static const Visits& sides(const Visits& visits, bool were, Output& out);

  GridSpec<Scalar, Dim> spec_;
  CellOptions options_;
  int shard_shift_ = 64;
  StepBudget* budget_ = nullptr;
  std::vector<Shard> shards_;
  std::vector<Waiting> waiting_;  // by block
  OpQueues ops_;                  // inserts, updates, erases
  OpQueues late_;                 // what comes after them
};

}  // namespace sweepgrid
