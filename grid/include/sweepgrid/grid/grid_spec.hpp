#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <sweepgrid/grid/cell_range.hpp>
#include <sweepgrid/grid/strict_math.hpp>
#include <sweepgrid/sap/box.hpp>

namespace sweepgrid {

/// How space is cut into cubic cells. There are no bounds: beyond the last coordinates, border cells reach to infinity,
/// so every box has a cell range.
///
/// Two boxes that overlap share a cell whatever the rounding, because the cell coordinate is a monotone function of
/// the world coordinate on each axis. Written as (x - a) * b, which no compiler can contract differently in two places.
template <class Scalar, int Dim>
class GridSpec {
 public:
  using Code = CellCode<Dim>;

  /// One cell over everything.
  GridSpec() { origin_.fill(0), limit_.fill(0); }

  /// Cells of edge `cell_size` (world units, positive). `origin`: a corner of the scene; precision is best near it.
  /// `limit`: the last coordinate of each axis, beyond which everything shares the border cells.
  GridSpec(double cell_size, const std::array<double, Dim>& origin, const CellCoordinates<Dim>& limit)
      : cell_size_(cell_size) {
    constexpr double kMax = std::numeric_limits<Real>::max();
    scale_ = static_cast<Real>(std::min(1 / cell_size, kMax));
    for (int i = 0; i < 2 * Dim; ++i) {
      limit_[i] = static_cast<Real>(limit[i % Dim]);
      // A difference that overflows takes a value to the last coordinate, which must be near that of its neighbours.
      const double least = kMax / cell_size < static_cast<double>(limit_[i]) ? 0 : -kMax;
      origin_[i] = static_cast<Real>(std::clamp(origin[i % Dim], least, kMax));
    }
  }

  /// As above without limits; `origin` lies so that as many cells as float can tell apart precisely are before it.
  static GridSpec unlimited(double cell_size, std::array<double, Dim> origin) {
    constexpr double kBefore = double{std::uint32_t{1} << std::min(16, Code::kAxisBits - 1)};
    for (double& o : origin) o -= kBefore * cell_size;
    CellCoordinates<Dim> limit;
    limit.fill(Code::kLastCoordinate);
    return GridSpec(cell_size, origin, limit);
  }

  /// Infinite for the one cell over everything.
  [[nodiscard]] double cell_size() const { return cell_size_; }

  [[nodiscard]] std::uint32_t coordinate(int axis, Scalar value) const { return coordinate_of(axis, value); }

  [[nodiscard, gnu::always_inline]] CellRange<Dim> range(const Box<Scalar, Dim>& box) const {
    std::array<Scalar, 2 * static_cast<std::size_t>(Dim)> ends;  // side by side, so that one vector holds them
    for (int axis = 0; axis < Dim; ++axis) ends[axis] = box.min[axis], ends[Dim + axis] = box.max[axis];
    CellRange<Dim> range;
    for (int i = 0; i < 2 * Dim; ++i) range.ends[i] = coordinate_of(i, ends[i]);
    return range;
  }

 private:
  using Real = std::conditional_t<std::is_same_v<Scalar, float>, float, double>;

  // Of end `i` of a box.
  [[nodiscard]] std::uint32_t coordinate_of(int i, Scalar value) const {
    // Clamped before the conversion: an integer cannot hold what a coordinate at 1e30 or infinity scales to. The order
    // of arguments matters: infinity times a scale of 0 is NaN, and max(0, NaN) is 0.
    const Real scaled = (static_cast<Real>(value) - origin_[i]) * scale_;
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::min(limit_[i], std::max(Real{0}, scaled))));
  }

  double cell_size_ = std::numeric_limits<double>::infinity();
  Real scale_ = 0;  // of the single cell: everything maps to coordinate 0
  // For the mins of a box, then again for its maxes.
  std::array<Real, 2 * static_cast<std::size_t>(Dim)> origin_;
  std::array<Real, 2 * static_cast<std::size_t>(Dim)> limit_;
};

}  // namespace sweepgrid
