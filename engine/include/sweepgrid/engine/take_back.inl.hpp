#pragma once

#include <algorithm>
#include <functional>
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
  if (sweeping_) {
    if constexpr (SceneSweep<Scalar, Dim>::kPossible) sweep_.cancel();
    counters_ = {};
    return;
  }
  levels_.clear();
  celled_ = gridded_ = false;
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
}

// Cells for all objects with the boxes of the latest step, in a grid that suits them.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::make_cells() {
  const auto scene = sample(GridFit<Scalar, Dim>::sample_size(objects_.size()));
  make_cells(scene, fit(scene));
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::make_cells(const std::vector<BoxType>& scene,
                                         const typename GridFit<Scalar, Dim>::Result& result) {
  celled_ = gridded_ = false;
  if (counting()) {
    start_single(result, bounded(result));
    fill_counted();
  } else {
    start_family(result.cell_size, result.lower, scene);
    regrid_.fitted(result.met, objects_.size());
    gridded_ = true;
    fill_cells();
  }
  celled_ = true;
}

// Two stages: objects to the grids, by block; the calls of a part of a grid into its cells.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::fill_cells() {
  const auto workers = static_cast<std::size_t>(executor_->concurrency());
  const std::uint32_t granules = objects_.granules();
  const std::size_t blocks =
      workers == 1 ? 1 : std::min<std::size_t>(granules + 1, engine_core::kBlocksPerWorker * workers);
  const auto for_block = [&](std::size_t block, auto&& visit) {
    const auto first = static_cast<std::uint32_t>(block * granules / blocks);
    const auto last = static_cast<std::uint32_t>((block + 1) * granules / blocks);
    for (ObjectId object = first * Objects::kGranule; object < std::min(last * Objects::kGranule, objects_.bound());
         ++object) {
      if (stepped<Scalar, Dim>(objects_.state(object))) visit(object, stepped_box(object));
    }
  };
  const auto for_each = [&](std::size_t tasks, const auto& body) {
    if (workers == 1 || tasks == 1) {
      for (std::size_t task = 0; task < tasks; ++task) body(task);
    } else {
      executor_->for_each(tasks, std::cref(body));
    }
  };
  for_each(blocks, [&](std::size_t block) {  // asks for levels
    for_block(block, [&](ObjectId, const BoxType& box) { static_cast<void>(levels_.home(LevelsType::width(box))); });
  });
  levels_.make_room(objects_.widest());
  for (const GridIndex grid : levels_.live()) levels_.grid(grid).begin_step(blocks);
  for_each(blocks, [&](std::size_t block) {
    for_block(block, [&](ObjectId object, const BoxType& box) {
      Record& record = objects_.record(object);
      record.grid = levels_.home(LevelsType::width(box));
      levels_.grid(record.grid).route_insert(block, object, box);
    });
    for (const GridIndex grid : levels_.live()) levels_.grid(grid).end_block(block);
  });
  std::vector<std::pair<GridIndex, std::size_t>> parts;
  for (const GridIndex grid : levels_.live()) {
    for (std::size_t shard = 0; shard < levels_.grid(grid).shards(); ++shard) parts.emplace_back(grid, shard);
  }
  for_each(parts.size(), [&](std::size_t part) {
    DrainOutput<Scalar, Dim> out;
    const auto box_of = [&](ObjectId object) -> const BoxType& { return stepped_box(object); };
    levels_.grid(parts[part].first).fill(parts[part].second, box_of, out);
  });
}

// With witness counts, cells count the pairs that they see.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::fill_counted() {
  for (Shard& shard : shards_) shard = Shard();
  const SteppedBoxes boxes(objects_);
  GridType& grid = levels_.grid(levels_.finest());
  grid.begin_step(1);
  for (ObjectId object = 0; object < objects_.bound(); ++object) {
    if (boxes.has(object)) grid.route_insert(0, object, objects_.record(object).box);
  }
  constexpr std::size_t kCellsAtOnce = 64;  // so that the deltas of all cells need not be kept at the same time
  const StepBoxes<Scalar, Dim> step_boxes(objects_, steps_ + 1);
  DrainOutput<Scalar, Dim> out;
  grid.end_block(0);
  for (std::size_t part = 0; part < grid.shards(); ++part) {
    grid.gather(part);
    const auto cells = grid.active(part);
    for (std::size_t first = 0; first < cells.size(); first += kCellsAtOnce) {
      out.clear();
      grid.drain(part, cells.subspan(first, std::min(kCellsAtOnce, cells.size() - first)), step_boxes, out);
      for (const OverlapDelta& delta : out.deltas) shards_[shard_of(delta.pair)].witnesses.apply({&delta, 1});
    }
  }
  for (Shard& shard : shards_) {
    shard.witnesses.finish(shard.begins.items, shard.ends.items);
    shard.begins = {};
    shard.ends = {};
  }
}

// The pairs of the latest step from the boxes alone, for while there are no cells: row by row, as rows were fitted to
// the latest sweep. A pair counts in the first row that it shares.
template <class Scalar, int Dim>
std::vector<PairKey> EngineCore<Scalar, Dim>::swept_pairs() const {
  struct Entry {
    std::uint32_t row;
    ObjectId object;
    std::uint32_t marks;
  };
  std::vector<Entry> entries;
  for (ObjectId object = 0; object < objects_.bound(); ++object) {
    if (!stepped<Scalar, Dim>(objects_.state(object))) continue;
    const auto put = [&](std::uint32_t row, std::uint32_t marks) { entries.push_back({row, object, marks}); };
    if constexpr (SceneSweep<Scalar, Dim>::kPossible) {
      sweep_.for_each_row(stepped_box(object), put);
    } else {
      put(0, 0);
    }
  }
  std::sort(entries.begin(), entries.end(),
            [](const Entry& a, const Entry& b) { return std::pair(a.row, a.object) < std::pair(b.row, b.object); });
  std::vector<PairKey> pairs;
  std::vector<CellOp<Scalar, Dim>> ops;
  for (auto first = entries.begin(), last = first; first != entries.end(); first = last) {
    ops.clear();
    for (; last != entries.end() && last->row == first->row; ++last) {
      ops.push_back({last->object, OpKind::kInsert, OrderedBox<Scalar, Dim>(stepped_box(last->object))});
    }
    const auto marks_of = [&](ObjectId object) {
      return std::lower_bound(first, last, object, [](const Entry& entry, ObjectId id) { return entry.object < id; })
          ->marks;
    };
    DeltaList deltas;
    SapCounters unused;
    make_cell<Scalar, Dim>({CellKind::kBatch})->drain(ops, deltas, unused);
    for (const OverlapDelta& delta : deltas) {
      if ((marks_of(delta.pair.lower()) & marks_of(delta.pair.upper())) == 0) pairs.push_back(delta.pair);
    }
  }
  return pairs;
}

}  // namespace sweepgrid
