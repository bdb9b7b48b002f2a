#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <sweepgrid/grid/cell_code.hpp>

namespace sweepgrid {

/// The cells that a box covers: a block of grid coordinates, both corners included.
template <int Dim>
struct CellRange {
  /// The lower corner, then the upper.
  std::array<std::uint32_t, 2 * static_cast<std::size_t>(Dim)> ends;

  [[nodiscard]] std::uint32_t first(int axis) const { return ends[axis]; }
  [[nodiscard]] std::uint32_t last(int axis) const { return ends[Dim + axis]; }

  [[nodiscard]] bool contains(const CellCoordinates<Dim>& cell) const {
    for (int axis = 0; axis < Dim; ++axis) {
      if (cell[axis] < first(axis) || cell[axis] > last(axis)) return false;
    }
    return true;
  }

  /// Whether the cell is surrounded by cells of the range. A box covers such a cell wholly, whatever the rounding.
  [[nodiscard]] bool surrounds(const CellCoordinates<Dim>& cell) const {
    for (int axis = 0; axis < Dim; ++axis) {
      if (cell[axis] <= first(axis) || cell[axis] >= last(axis)) return false;
    }
    return true;
  }

  /// Number of cells; double, because a box over everything would overflow an integer.
  [[nodiscard]] double count() const {
    double cells = 1;
    for (int axis = 0; axis < Dim; ++axis) cells *= static_cast<double>(last(axis) - first(axis)) + 1;
    return cells;
  }

  /// Whether no axis has more than two cells: as it is for boxes that are not wider than cells.
  [[nodiscard]] bool few() const {
    std::uint32_t beyond_first = 0;
    for (int axis = 0; axis < Dim; ++axis) beyond_first |= last(axis) - first(axis);
    return beyond_first <= 1;
  }

  /// Calls `visit` with the code of each corner, and whether the corner is a cell that did not come before. How many
  /// there are cannot be foretold, so a loop over just those would be slower. Precondition: few().
  template <class Visit>
  void for_each_corner(Visit&& visit) const {
    std::array<std::array<std::uint64_t, 2>, Dim> parts;
    unsigned wide = 0;  // axes of two cells, by bit
    for (int axis = 0; axis < Dim; ++axis) {
      parts[axis] = {CellCode<Dim>::part(axis, first(axis)), CellCode<Dim>::part(axis, last(axis))};
      wide |= (last(axis) - first(axis)) << axis;
    }
    for (unsigned corner = 0; corner < 1U << Dim; ++corner) {
      std::uint64_t code = 0;
      for (int axis = 0; axis < Dim; ++axis) code |= parts[axis][corner >> axis & 1];
      visit(code, (corner & ~wide) == 0);
    }
  }

  /// Calls `visit` with the code of every cell.
  template <class Visit>
  void for_each(Visit&& visit) const {
    walk<Dim - 1>(0, visit);
  }

  friend bool operator==(const CellRange& a, const CellRange& b) {
    // Without a branch for each coordinate: that they are all equal is what is expected.
    std::uint32_t difference = 0;
    for (int i = 0; i < 2 * Dim; ++i) difference |= a.ends[i] ^ b.ends[i];
    return difference == 0;
  }

 private:
  template <int kAxis, class Visit>
  void walk(std::uint64_t code, Visit& visit) const {
    for (std::uint32_t c = first(kAxis); c <= last(kAxis); ++c) {
      const std::uint64_t next = code | CellCode<Dim>::part(kAxis, c);
      if constexpr (kAxis == 0) {
        visit(next);
      } else {
        walk<kAxis - 1>(next, visit);
      }
    }
  }
};

}  // namespace sweepgrid
