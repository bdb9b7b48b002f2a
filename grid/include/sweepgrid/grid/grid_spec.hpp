#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <type_traits>

#include <sweepgrid/grid/cell_range.hpp>
#include <sweepgrid/sap/box.hpp>

namespace sweepgrid {

/// Number of a cell: its grid coordinates in row-major order, the last axis slowest.
using CellIndex = std::uint32_t;

/// How space is cut into cubic cells. The border cells reach to infinity, so every box has a cell range.
///
/// Two boxes that overlap share a cell whatever the rounding, because the cell coordinate is a monotone function of
/// the world coordinate on each axis.
template <class Scalar, int Dim>
class GridSpec {
 public:
  static constexpr std::uint64_t kMaxCells = std::uint64_t{1} << 24;
  static constexpr std::uint64_t kMaxCellsPerAxis = std::uint64_t{1} << 16;
  using Counts = std::array<std::uint32_t, static_cast<std::size_t>(Dim)>;

  /// One cell over everything.
  GridSpec() { counts_.fill(1), origin_.fill(0); }

  /// Cells of edge `cell_size` (world units, positive) over `lower` to `upper` (finite).
  /// Throws std::invalid_argument for more than kMaxCells cells, or kMaxCellsPerAxis on an axis.
  GridSpec(const std::array<double, Dim>& lower, const std::array<double, Dim>& upper, double cell_size)
      : cell_size_(cell_size), scale_(static_cast<Real>(1 / cell_size)) {
    double total = 1;
    for (int axis = 0; axis < Dim; ++axis) {
      constexpr double kLimit = std::numeric_limits<Real>::max();
      origin_[axis] = static_cast<Real>(std::clamp(lower[axis], -kLimit, kLimit));
      const double cells = std::max(1.0, std::ceil((upper[axis] - lower[axis]) / cell_size));
      total *= cells;
      if (!(cells <= kMaxCellsPerAxis && total <= kMaxCells)) {
        std::ostringstream text;
        text << "sweepgrid: cell_size " << cell_size << " makes more than " << kMaxCells << " cells, or more than "
             << kMaxCellsPerAxis << " on one axis, over the bounds";
        throw std::invalid_argument(text.str());
      }
      counts_[axis] = static_cast<std::uint32_t>(cells);
    }
  }

  [[nodiscard]] double cell_size() const { return cell_size_; }
  [[nodiscard]] const Counts& counts() const { return counts_; }

  [[nodiscard]] std::uint32_t cell_count() const {
    std::uint32_t cells = 1;
    for (const std::uint32_t count : counts_) cells *= count;
    return cells;
  }

  [[nodiscard]] CellRange<Dim> range(const Box<Scalar, Dim>& box) const {
    CellRange<Dim> range;
    for (int axis = 0; axis < Dim; ++axis) {
      range.first[axis] = coordinate(axis, box.min[axis]);
      range.last[axis] = coordinate(axis, box.max[axis]);
    }
    return range;
  }

  /// Whether the box lies wholly beyond the bounds on some axis: exact there, but served by border cells.
  [[nodiscard]] bool outside(const Box<Scalar, Dim>& box) const {
    bool out = false;
    for (int axis = 0; axis < Dim; ++axis) {
      const Real extent = static_cast<Real>(counts_[axis]);
      out |= scaled(axis, box.max[axis]) < 0 || scaled(axis, box.min[axis]) > extent;
    }
    return out;
  }

  [[nodiscard]] CellIndex index(const std::array<std::uint16_t, static_cast<std::size_t>(Dim)>& cell) const {
    CellIndex index = 0;
    for (int axis = Dim - 1; axis >= 0; --axis) index = index * counts_[axis] + cell[axis];
    return index;
  }

 private:
  using Real = std::conditional_t<std::is_same_v<Scalar, float>, float, double>;

  [[nodiscard]] Real scaled(int axis, Scalar value) const {
    return (static_cast<Real>(value) - origin_[axis]) * scale_;
  }

  [[nodiscard]] std::uint16_t coordinate(int axis, Scalar value) const {
    // Clamped before the conversion: an integer cannot hold what a coordinate at 1e30 or infinity scales to. The order
    // of arguments matters: infinity times the single cell's scale of 0 is NaN, and max(0, NaN) is 0.
    const Real limit = static_cast<Real>(counts_[axis] - 1);
    return static_cast<std::uint16_t>(std::min(limit, std::max(Real{0}, scaled(axis, value))));
  }

  double cell_size_ = 1;
  Real scale_ = 0;  // of the single cell: everything maps to coordinate 0
  std::array<Real, static_cast<std::size_t>(Dim)> origin_;
  Counts counts_;
};

}  // namespace sweepgrid
