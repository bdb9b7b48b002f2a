#pragma once

#include <utility>
#include <vector>

#include <sweepgrid/engine/engine_core.hpp>
#include <sweepgrid/engine/reporter.hpp>

namespace sweepgrid {

// What becomes of a step that is over its budget, or that threw: ops are queued again, and the cells, in which some had
// been applied already, are made anew from the boxes of the step before.

/// Whether the latest step knew of an object of this state.
template <class Scalar, int Dim>
[[nodiscard]] bool stepped(std::uint8_t state) {
  return state != 0 && (state & ObjectTable<Scalar, Dim>::kInserted) == 0;
}

/// For as long as it lives, the boxes of all objects are those of the latest step.
template <class Scalar, int Dim>
class SteppedBoxes {
 public:
  using Objects = ObjectTable<Scalar, Dim>;

  explicit SteppedBoxes(Objects& objects) : objects_(objects) { exchange(); }
  ~SteppedBoxes() { exchange(); }
  SteppedBoxes(const SteppedBoxes&) = delete;
  SteppedBoxes& operator=(const SteppedBoxes&) = delete;

  [[nodiscard]] bool has(ObjectId object) const { return stepped<Scalar, Dim>(objects_.state(object)); }

 private:
  void exchange() {
    for (ObjectId object = 0; object < objects_.bound(); ++object) {
      auto& record = objects_.record(object);
      if (has(object) && (objects_.state(object) & Objects::kQueued) != 0) std::swap(record.box, record.before);
    }
  }

  Objects& objects_;
};

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::take_back_step() noexcept {
  broken_ = true;
  const std::uint64_t step = steps_ + 1;
  for (const RouteBlock& block : blocks_) {
    for (const ObjectId object : block.retired.items) {
      // Inserted and erased since the latest step.
      if (objects_.record(object).changed_at != step) {
        objects_.requeue(object, Objects::kLive | Objects::kInserted | Objects::kErased);
      }
    }
  }
  for (ObjectId object = 0; object < objects_.bound(); ++object) {
    const Record& record = objects_.record(object);
    if (record.changed_at == step) {
      objects_.requeue(object, record.change);
    } else if ((objects_.state(object) & Objects::kQueued) != 0) {
      objects_.mark(object);
    }
  }
  blocks_ = {};
  gathers_ = {};
  tasks_ = {};
  counters_ = {};
  try {
    restore_cells();
  } catch (...) {
    // The next step tries again; until then pairs() does without cells.
  }
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::restore_cells() {
  regridding_ = false;
  relocation_ = {};
  levels_.clear();
  for (Shard& shard : shards_) shard = Shard();
  const SteppedBoxes boxes(objects_);
  const auto scene = sample(GridFit<Scalar, Dim>::sample_size(objects_.size()));
  const auto result = fit(scene);
  if (counting()) {
    start_single(result, bounded(result));
  } else {
    start_family(result.cell_size, result.lower, scene);
    regrid_.fitted(result.met, objects_.size());
    gridded_ = true;
  }
  for (const GridIndex grid : levels_.live()) levels_.grid(grid).begin_step(1, false);
  for (ObjectId object = 0; object < objects_.bound(); ++object) {
    if (!boxes.has(object)) continue;
    Record& record = objects_.record(object);
    record.grid = levels_.home(LevelsType::width(record.box));
    if (counting()) {
      levels_.grid(record.grid).route_insert(0, object, record.box);
    } else {
      levels_.grid(record.grid).route_attach(0, object, record.box);
    }
  }
  for (const GridIndex grid : levels_.live()) restore_cells_of(levels_.grid(grid));
  counters_ = {};
  broken_ = false;
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::restore_cells_of(GridType& grid) {
  constexpr std::size_t kCellsAtOnce = 64;  // so that the deltas of all cells need not be kept at the same time
  const StepBoxes<Scalar, Dim> boxes(objects_, steps_ + 1);
  DrainOutput<Scalar, Dim> out;
  grid.end_block(0);
  for (std::size_t part = 0; part < grid.shards(); ++part) {
    grid.gather(part);
    const auto cells = grid.active(part);
    for (std::size_t first = 0; first < cells.size(); first += kCellsAtOnce) {
      out.clear();
      grid.drain(part, cells.subspan(first, std::min(kCellsAtOnce, cells.size() - first)), boxes, out);
      for (const OverlapDelta& delta : out.deltas) shards_[shard_of(delta.pair)].witnesses.apply({&delta, 1});
    }
  }
  if (!counting()) return;
  for (Shard& shard : shards_) {
    shard.witnesses.finish(shard.begins.items, shard.ends.items);
    shard.begins = {};
    shard.ends = {};
  }
}

// The pairs of the latest step from the boxes alone, for while there are no cells.
template <class Scalar, int Dim>
std::vector<PairKey> EngineCore<Scalar, Dim>::swept_pairs() const {
  std::vector<CellOp<Scalar, Dim>> ops;
  ops.reserve(objects_.size());
  for (ObjectId object = 0; object < objects_.bound(); ++object) {
    if (!stepped<Scalar, Dim>(objects_.state(object))) continue;
    ops.push_back({object, OpKind::kInsert, OrderedBox<Scalar, Dim>(stepped_box(object))});
  }
  DeltaList deltas;
  SapCounters unused;
  make_cell<Scalar, Dim>({CellKind::kBatch})->drain(ops, deltas, unused);
  std::vector<PairKey> pairs;
  pairs.reserve(deltas.size());
  for (const OverlapDelta& delta : deltas) pairs.push_back(delta.pair);
  return pairs;
}

}  // namespace sweepgrid
