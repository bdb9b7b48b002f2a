#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace sweepgrid {

/// The cells that a box covers: a block of grid coordinates, both corners included.
template <int Dim>
struct CellRange {
  std::array<std::uint16_t, static_cast<std::size_t>(Dim)> first;
  std::array<std::uint16_t, static_cast<std::size_t>(Dim)> last;

  [[nodiscard]] bool contains(const std::array<std::uint16_t, static_cast<std::size_t>(Dim)>& cell) const {
    for (int axis = 0; axis < Dim; ++axis) {
      if (cell[axis] < first[axis] || cell[axis] > last[axis]) return false;
    }
    return true;
  }

  [[nodiscard]] std::uint64_t count() const {
    std::uint64_t cells = 1;
    for (int axis = 0; axis < Dim; ++axis) cells *= std::uint64_t{last[axis]} - first[axis] + 1;
    return cells;
  }

  friend bool operator==(const CellRange&, const CellRange&) = default;
};

}  // namespace sweepgrid
