#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <sweepgrid/engine/engine_core.hpp>
#include <sweepgrid/sap/invariant.hpp>

namespace sweepgrid {

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::validate() const {
  for (ObjectId object = 0; object < objects_.bound(); ++object) {
    require_invariant((objects_.state(object) & Objects::kQueued) == 0, "G2",
                      [&] { return "object " + std::to_string(object) + " still has a queued op"; });
  }
  if (!gridded_) return;
  for (CellIndex cell = 0; cell < grid_.spec().cell_count(); ++cell) {
    if (grid_.cell(cell) != nullptr) grid_.cell(cell)->validate();
  }
  validate_residents();
  validate_witnesses();
}

// G1: a box is in exactly the cells of its range, with the coordinates that the client gave.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::validate_residents() const {
  std::vector<std::uint64_t> cells_of(objects_.bound(), 0);
  std::vector<typename SweepAndPrune<Scalar, Dim>::Resident> residents;
  const auto& counts = grid_.spec().counts();
  for (CellIndex index = 0; index < grid_.spec().cell_count(); ++index) {
    if (grid_.cell(index) == nullptr) continue;
    std::array<std::uint16_t, static_cast<std::size_t>(Dim)> coordinates;
    CellIndex rest = index;
    for (int axis = 0; axis < Dim; rest /= counts[axis++]) {
      coordinates[axis] = static_cast<std::uint16_t>(rest % counts[axis]);
    }
    residents.clear();
    grid_.cell(index)->append_residents(residents);
    for (const auto& resident : residents) {
      const ObjectId object = resident.object;
      const auto name = [&] { return "object " + std::to_string(object) + " in cell " + std::to_string(index); };
      require_invariant(object < objects_.bound() && objects_.state(object) != 0, "G1",
                        [&] { return name() + " does not exist"; });
      const auto& record = objects_.record(object);
      require_invariant(record.range.contains(coordinates), "G1", [&] { return name() + " does not belong there"; });
      require_invariant(resident.box == OrderedBox<Scalar, Dim>(record.box), "G1",
                        [&] { return name() + " has another box than the client gave"; });
      ++cells_of[object];
    }
  }
  std::size_t live = 0;
  for (ObjectId object = 0; object < objects_.bound(); ++object) {
    if (objects_.state(object) == 0) continue;
    ++live;
    const auto& record = objects_.record(object);
    require_invariant(record.range == grid_.spec().range(record.box) && cells_of[object] == record.range.count(), "G1",
                      [&] { return "object " + std::to_string(object) + " is not in all cells of its range"; });
  }
  require_invariant(live == objects_.size(), "G1", [] { return "the number of live objects is wrong"; });
}

// S4 and E1: counted anew from the boxes in each cell, every pair has the witness count that the table says.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::validate_witnesses() const {
  std::vector<PairKey> seen;
  std::vector<typename SweepAndPrune<Scalar, Dim>::Resident> residents;
  for (CellIndex index = 0; index < grid_.spec().cell_count(); ++index) {
    if (grid_.cell(index) == nullptr) continue;
    residents.clear();
    grid_.cell(index)->append_residents(residents);
    std::sort(residents.begin(), residents.end(),
              [](const auto& a, const auto& b) { return a.box.min[0] < b.box.min[0]; });
    for (std::size_t i = 0; i < residents.size(); ++i) {
      for (std::size_t j = i + 1; j < residents.size() && residents[j].box.min[0] <= residents[i].box.max[0]; ++j) {
        if (residents[i].box.overlaps(residents[j].box)) seen.emplace_back(residents[i].object, residents[j].object);
      }
    }
  }
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
