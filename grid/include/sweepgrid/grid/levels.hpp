#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#include <sweepgrid/grid/grid.hpp>
#include <sweepgrid/grid/grid_spec.hpp>

namespace sweepgrid {

/// Number of a grid among those that exist.
using GridIndex = std::uint8_t;

/// The grids of a scene: a family of levels, each with cells four times as wide as the one before, so that a box is in
/// few cells whatever its size; the last is one cell over everything. A level exists once a box asks for it. An object
/// lives in one grid.
///
/// Not thread-safe but for home(), which many may call at once.
template <class Scalar, int Dim>
class Levels {
 public:
  using GridType = Grid<Scalar, Dim>;
  using BoxType = Box<Scalar, Dim>;
  static constexpr GridIndex kNone = 255;

  using Real = std::conditional_t<std::is_same_v<Scalar, float>, float, double>;
  /// Longest edge of a box; infinite boxes are infinitely wide.
  [[nodiscard]] static Real width(const BoxType& box) {
    Real width = 0;
    for (int axis = 0; axis < Dim; ++axis) {
      width = std::max(width, static_cast<Real>(box.max[axis]) - static_cast<Real>(box.min[axis]));
    }
    // Infinity minus infinity is NaN, which max() passes over: then it is one of the other edges.
    return width;
  }
  /// Whether an edge of the box is longer than that.
  [[nodiscard, gnu::always_inline]] static bool wider(const BoxType& box, Real width) {
    bool wider = false;
    for (int axis = 0; axis < Dim; ++axis) {
      wider |= static_cast<Real>(box.max[axis]) - static_cast<Real>(box.min[axis]) > width;
    }
    return wider;
  }

  /// Drops all grids. From now on, homes are in a new family. `shards`: of each of its grids.
  void start_family(double cell_size, const std::array<double, Dim>& origin, const CellOptions& cells,
                    std::size_t shards);
  /// Drops all grids. Precondition of what follows: a new family, or a single grid.
  void clear();
  /// From now on, every home is in this one grid, and there are no others.
  void start_single(const GridSpec<Scalar, Dim>& spec, const CellOptions& cells, std::size_t shards);

  /// Makes the levels that were asked for, and sees to it that boxes up to this width have a home. Returns whether
  /// there are new homes.
  bool make_room(double widest);

  /// Where a box of this width should live: the finest existing grid that holds it.
  /// Precondition: make_room() for as wide a box.
  [[nodiscard]] GridIndex home(double width) const;
  /// Whether a box of this width may stay in the grid: it is in few cells there.
  [[nodiscard]] bool holds(GridIndex grid, double width) const { return width <= widest_[grid]; }

  /// Cell size at the finest level.
  [[nodiscard]] double cell_size() const { return cell_size_; }
  [[nodiscard]] const std::array<double, Dim>& origin() const { return origin_; }
  [[nodiscard]] GridIndex finest() const { return homes_[0]; }

  [[nodiscard]] GridType& grid(GridIndex index) { return *grids_[index]; }
  [[nodiscard]] const GridType& grid(GridIndex index) const { return *grids_[index]; }
  /// Those that exist, in order of index.
  [[nodiscard]] const std::vector<GridIndex>& live() const { return live_; }
  /// A strict total order, for no two have cells of one size.
  [[nodiscard]] bool coarser(GridIndex a, GridIndex b) const {
    return grids_[a]->spec().cell_size() > grids_[b]->spec().cell_size();
  }

  /// Heap bytes held beside what the grids say of themselves.
  [[nodiscard]] std::size_t bytes() const {
    return live_.size() * sizeof(GridType) + grids_.capacity() * sizeof(grids_[0]) +
           widest_.capacity() * sizeof(widest_[0]) + live_.capacity() * sizeof(live_[0]);
  }

  /// Drops the grids that have no cell, but for the finest. Returns how wide a box now has a home.
  double drop_empty();

 private:
  static constexpr int kLevels = 16;  // the last is the one cell over everything
  static constexpr double kRatio = 4;

  [[nodiscard]] int level_of(double width) const;
  GridIndex add(const GridSpec<Scalar, Dim>& spec, double widest);

  CellOptions cells_;
  std::size_t shards_ = 1;
  double cell_size_ = 1;
  std::array<double, Dim> origin_{};
  std::array<GridIndex, kLevels> homes_ = none();  // by level
  mutable std::atomic<std::uint32_t> wanted_ = 0;  // levels that a box would have lived in, by bit
  std::vector<std::unique_ptr<GridType>> grids_;   // by index
  std::vector<double> widest_;                     // by index: widest box that the grid is meant for
  std::vector<GridIndex> live_;

  static std::array<GridIndex, kLevels> none() {
    std::array<GridIndex, kLevels> homes;
    homes.fill(kNone);
    return homes;
  }
};

}  // namespace sweepgrid
