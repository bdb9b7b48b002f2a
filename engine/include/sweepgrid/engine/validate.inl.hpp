#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <sweepgrid/engine/engine_core.hpp>
#include <sweepgrid/sap/invariant.hpp>

namespace sweepgrid {

// Every pair of overlapping objects, each once, from the boxes of the latest step: in the cell of the corner where the
// events of the pair are reported, too.
template <class Scalar, int Dim>
template <class Visit>
void EngineCore<Scalar, Dim>::for_each_pair(Visit&& visit) const {
  std::vector<typename SweepAndPrune<Scalar, Dim>::Resident> residents;
  for (const GridIndex index : levels_.live()) {
    levels_.grid(index).for_each_cell([&](const auto& cell) {
      residents.clear();
      cell.kind().append_residents(residents);
      std::sort(residents.begin(), residents.end(),
                [](const auto& a, const auto& b) { return a.box.min[0] < b.box.min[0]; });
      for (std::size_t i = 0; i < residents.size(); ++i) {
        for (std::size_t j = i + 1; j < residents.size() && residents[j].box.min[0] <= residents[i].box.max[0]; ++j) {
          const PairKey pair(residents[i].object, residents[j].object);
          if (residents[i].box.overlaps(residents[j].box) && meet_in(pair, index, cell.code())) visit(pair);
        }
      }
    });
  }
  if (levels_.live().size() == 1) return;
  for (ObjectId object = 0; object < objects_.bound(); ++object) {
    const std::uint8_t state = objects_.state(object);
    if (state == 0 || (state & Objects::kInserted) != 0) continue;
    const BoxType& box = stepped_box(object);
    const OrderedBox<Scalar, Dim> ordered(box);
    const GridIndex home = objects_.record(object).grid;
    for (const GridIndex index : levels_.live()) {
      if (index == home || !levels_.coarser(index, home)) continue;
      const GridType& grid = levels_.grid(index);
      grid.spec().range(box).for_each([&](std::uint64_t code) {
        const auto* cell = grid.find(code);
        if (cell == nullptr) return;
        residents.clear();
        cell->kind().append_residents(residents);
        for (const auto& resident : residents) {
          const PairKey pair(resident.object, object);
          if (resident.box.overlaps(ordered) && meet_in(pair, index, code)) visit(pair);
        }
      });
    }
  }
}

// The box of the latest step. Precondition: it had one.
template <class Scalar, int Dim>
auto EngineCore<Scalar, Dim>::stepped_box(ObjectId object) const -> const BoxType& {
  const bool queued = (objects_.state(object) & Objects::kQueued) != 0;
  return queued ? objects_.record(object).before : objects_.record(object).box;
}

template <class Scalar, int Dim>
bool EngineCore<Scalar, Dim>::meet_in(PairKey pair, GridIndex grid, std::uint64_t cell) const {
  return Reporter<Scalar, Dim>::corner(stepped_box(pair.lower()), stepped_box(pair.upper()),
                                       levels_.grid(grid).spec()) == cell;
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::validate() const {
  for (ObjectId object = 0; object < objects_.bound(); ++object) {
    require_invariant((objects_.state(object) & Objects::kQueued) == 0, "G2",
                      [&] { return "object " + std::to_string(object) + " still has a queued op"; });
  }
  if (!celled_) return validate_pairs();
  for (const GridIndex index : levels_.live()) {
    levels_.grid(index).for_each_cell([](const auto& cell) { cell.kind().validate(); });
  }
  validate_residents();
  counting() ? validate_witnesses() : validate_pairs();
}

// G1: a box is in exactly the cells of its range, with the coordinates that the client gave.
// G3: no box is wider than the grid that it lives in is meant for, so no box is in many cells.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::validate_residents() const {
  std::vector<std::uint64_t> cells_of(objects_.bound(), 0);
  std::vector<typename SweepAndPrune<Scalar, Dim>::Resident> residents;
  for (const GridIndex index : levels_.live()) {
    const GridType& grid = levels_.grid(index);
    grid.for_each_cell([&](const auto& cell) {
      residents.clear();
      cell.kind().append_residents(residents);
      require_invariant(!residents.empty(), "G1", [] { return "an empty cell was kept"; });
      for (const auto& resident : residents) {
        const ObjectId object = resident.object;
        const auto name = [&] {
          return "object " + std::to_string(object) + " in cell " + std::to_string(cell.code()) + " of grid " +
                 std::to_string(index);
        };
        require_invariant(object < objects_.bound() && objects_.state(object) != 0, "G1",
                          [&] { return name() + " does not exist"; });
        const auto& record = objects_.record(object);
        require_invariant(
            record.grid == index && grid.spec().range(record.box).contains(CellCode<Dim>::coordinates(cell.code())),
            "G1", [&] { return name() + " does not belong there"; });
        require_invariant(resident.box == OrderedBox<Scalar, Dim>(record.box), "G1",
                          [&] { return name() + " has another box than the client gave"; });
        ++cells_of[object];
      }
    });
  }
  std::size_t live = 0;
  for (ObjectId object = 0; object < objects_.bound(); ++object) {
    if (objects_.state(object) == 0) continue;
    ++live;
    const auto& record = objects_.record(object);
    require_invariant(
        static_cast<double>(cells_of[object]) == levels_.grid(record.grid).spec().range(record.box).count(), "G1",
        [&] { return "object " + std::to_string(object) + " is not in all cells of its range"; });
    require_invariant(levels_.holds(record.grid, LevelsType::width(record.box)), "G3", [&] {
      return "object " + std::to_string(object) + " is too wide for grid " + std::to_string(record.grid);
    });
  }
  require_invariant(live == objects_.size(), "G1", [] { return "the number of live objects is wrong"; });
}

// S4 as far as it can be seen without a table of pairs: what began less what ended is what overlaps.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::validate_pairs() const {
  std::size_t overlapping = 0;
  if (celled_) {
    for_each_pair([&](PairKey) { ++overlapping; });
  } else {
    overlapping = swept_pairs().size();
  }
  require_invariant(overlapping == pairs_, "S4", [&] {
    return std::to_string(overlapping) + " pairs overlap, but by the events there should be " + std::to_string(pairs_);
  });
}

// S4 and E1: counted anew from the boxes in each cell, every pair has the witness count that the table says.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::validate_witnesses() const {
  std::vector<PairKey> seen;
  std::vector<typename SweepAndPrune<Scalar, Dim>::Resident> residents;
  if (!gridded_) return;
  levels_.grid(levels_.finest()).for_each_cell([&](const auto& cell) {
    residents.clear();
    cell.kind().append_residents(residents);
    std::sort(residents.begin(), residents.end(),
              [](const auto& a, const auto& b) { return a.box.min[0] < b.box.min[0]; });
    for (std::size_t i = 0; i < residents.size(); ++i) {
      for (std::size_t j = i + 1; j < residents.size() && residents[j].box.min[0] <= residents[i].box.max[0]; ++j) {
        if (residents[i].box.overlaps(residents[j].box)) seen.emplace_back(residents[i].object, residents[j].object);
      }
    }
  });
  std::sort(seen.begin(), seen.end());
  std::size_t pairs = 0;
  for (std::size_t first = 0, end = 0; first < seen.size(); first = end, ++pairs) {
    while (end < seen.size() && seen[end] == seen[first]) ++end;
    const PairKey pair = seen[first];
    const std::int32_t count = shards_[shard_of(pair)].witnesses.count(pair);
    require_invariant(static_cast<std::size_t>(count) == end - first, count == 0 ? "S4" : "E1", [&] {
      return "pair of objects " + std::to_string(pair.lower()) + " and " + std::to_string(pair.upper()) +
             " overlaps in " + std::to_string(end - first) + " cells, but its witness count is " +
             std::to_string(count);
    });
  }
  std::size_t known = 0;
  for (const Shard& shard : shards_) known += shard.witnesses.size();
  require_invariant(known == pairs, "E1", [&] {
    return std::to_string(known) + " pairs have a witness count, but " + std::to_string(pairs) + " pairs overlap";
  });
}

}  // namespace sweepgrid
