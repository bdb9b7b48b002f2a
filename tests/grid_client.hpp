#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <sweepgrid/grid/grid.hpp>
#include <sweepgrid/grid/grid.inl.hpp>

/// A grid by itself, with the boxes that it asks for; what an engine does with one in a step, in small.
namespace sweepgrid::oracle {

/// The boxes of the running step by object: absent means that there was none, or is none.
template <class Scalar, int Dim>
class ClientBoxes {
 public:
  using BoxType = Box<Scalar, Dim>;

  struct Object {
    std::optional<BoxType> before;
    std::optional<BoxType> after;
  };

  Object& operator[](ObjectId object) { return objects_[object]; }
  [[nodiscard]] const std::map<ObjectId, Object>& all() const { return objects_; }

  /// Begins a step: what was after is before now.
  void settle() {
    std::erase_if(objects_, [](const auto& entry) { return !entry.second.after; });
    for (auto& [object, boxes] : objects_) boxes.before = boxes.after;
  }

  [[nodiscard]] bool changed(ObjectId object) const {
    const Object& boxes = objects_.at(object);
    return boxes.before != boxes.after;
  }
  [[nodiscard]] const BoxType& before(ObjectId object) const { return *objects_.at(object).before; }
  // An erase is given a box, too, and does not look at it.
  [[nodiscard]] const BoxType& after(ObjectId object) const {
    const Object& boxes = objects_.at(object);
    return boxes.after ? *boxes.after : *boxes.before;
  }
  void prefetch(ObjectId) const {}

 private:
  std::map<ObjectId, Object> objects_;
};

/// Sums of deltas by the code of the cell and the pair; sums of zero are left out.
using CellSums = std::map<std::pair<std::uint64_t, PairKey>, int>;

/// Gathers and drains all that was routed, and drops what is empty.
template <class Scalar, int Dim>
CellSums finish_step(Grid<Scalar, Dim>& grid, const ClientBoxes<Scalar, Dim>& boxes, std::size_t blocks = 1) {
  CellSums sums;
  for (std::size_t block = 0; block < blocks; ++block) grid.end_block(block);
  for (std::size_t shard = 0; shard < grid.shards(); ++shard) {
    DrainOutput<Scalar, Dim> out;
    grid.gather(shard);
    grid.drain(shard, grid.active(shard), boxes, out);
    std::size_t i = 0;
    for (const auto& run : out.runs) {
      for (; i < run.end; ++i) sums[{run.cell, out.deltas[i].pair}] += out.deltas[i].change;
    }
    grid.drop_empty(shard, out.emptied);
  }
  std::erase_if(sums, [](const auto& entry) { return entry.second == 0; });
  return sums;
}

/// Codes of the cells that each object lives in, with a box as given; `fits` is told otherwise.
template <class Scalar, int Dim, class Fits>
std::map<ObjectId, std::set<std::uint64_t>> homes(const Grid<Scalar, Dim>& grid, Fits&& fits) {
  std::map<ObjectId, std::set<std::uint64_t>> cells;
  grid.for_each_cell([&](const auto& cell) {
    std::vector<typename SweepAndPrune<Scalar, Dim>::Resident> residents;
    cell.kind().append_residents(residents);
    for (const auto& resident : residents) {
      fits(resident);
      cells[resident.object].insert(cell.code());
    }
  });
  return cells;
}

template <class Scalar, int Dim>
std::set<std::uint64_t> cells_of(const GridSpec<Scalar, Dim>& spec, const Box<Scalar, Dim>& box) {
  std::set<std::uint64_t> cells;
  spec.range(box).for_each([&](std::uint64_t code) { cells.insert(code); });
  return cells;
}

}  // namespace sweepgrid::oracle
