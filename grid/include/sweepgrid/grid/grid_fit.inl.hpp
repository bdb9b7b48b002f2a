#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <sweepgrid/grid/grid_fit.hpp>

namespace sweepgrid {

namespace grid_fit {

template <int Dim>
using Points = std::vector<std::array<double, Dim>>;

// A cell must be wider than most boxes, or boxes are copied into many cells: twice the upper quartile.
template <class Scalar, int Dim>
double smallest_cell(const std::vector<Box<Scalar, Dim>>& sample) {
  std::vector<double> widths;
  for (const auto& box : sample) {
    double width = 0;
    for (int axis = 0; axis < Dim; ++axis) {
      width = std::max(width, static_cast<double>(box.max[axis]) - static_cast<double>(box.min[axis]));
    }
    if (std::isfinite(width)) widths.push_back(width);
  }
  if (widths.empty()) return 0;
  const auto upper = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() * 3 / 4);
  std::nth_element(widths.begin(), upper, widths.end());
  return 2 * *upper;
}

template <class Scalar, int Dim>
Points<Dim> centres(const std::vector<Box<Scalar, Dim>>& sample) {
  Points<Dim> points;
  for (const auto& box : sample) {
    std::array<double, Dim> centre;
    bool finite = true;
    for (int axis = 0; axis < Dim; ++axis) {
      centre[axis] = static_cast<double>(box.min[axis]) / 2 + static_cast<double>(box.max[axis]) / 2;
      finite &= std::isfinite(centre[axis]);
    }
    if (finite) points.push_back(centre);
  }
  return points;
}

// Bounds between quantiles, so that a few objects far away do not stretch the grid over empty space.
template <int Dim>
void bounds_of(const Points<Dim>& points, std::array<double, Dim>& lower, std::array<double, Dim>& upper) {
  lower.fill(0), upper.fill(0);
  if (points.empty()) return;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < Dim; ++axis) {
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][axis];
    const std::size_t skipped = points.size() / 200;
    std::sort(values.begin(), values.end());
    lower[axis] = values[skipped];
    upper[axis] = values[points.size() - 1 - skipped];
    const double slack = (upper[axis] - lower[axis]) * 0.02;
    lower[axis] -= slack, upper[axis] += slack;
  }
}

// Objects that the average object shares its cell with, were all `objects` placed like the sample. Counting pairs, not
// objects per cell, makes the estimate independent of the sample's size.
template <int Dim>
double companions(const Points<Dim>& points, const std::array<double, Dim>& lower, double size, std::size_t objects,
                  std::vector<std::uint64_t>& cells) {
  cells.clear();
  for (const auto& point : points) {
    std::uint64_t cell = 0;
    for (int axis = 0; axis < Dim; ++axis) {
      const double coordinate = std::clamp((point[axis] - lower[axis]) / size, 0.0, 65535.0);
      cell = cell * 65536 + static_cast<std::uint64_t>(coordinate);
    }
    cells.push_back(cell);
  }
  std::sort(cells.begin(), cells.end());
  double pairs = 0;
  for (std::size_t begin = 0, end = 0; begin < cells.size(); begin = end) {
    while (end < cells.size() && cells[end] == cells[begin]) ++end;
    pairs += static_cast<double>(end - begin) * static_cast<double>(end - begin - 1);
  }
  const double sample = static_cast<double>(points.size());
  return pairs / sample * (static_cast<double>(objects) / sample);
}

}  // namespace grid_fit

template <class Scalar, int Dim>
GridSpec<Scalar, Dim> GridFit<Scalar, Dim>::derive(const std::vector<Box<Scalar, Dim>>& sample,
                                                   std::size_t objects) const {
  const auto points = grid_fit::centres(sample);
  std::array<double, Dim> lower;
  std::array<double, Dim> upper;
  grid_fit::bounds_of<Dim>(points, lower, upper);
  if (bounds) {
    for (int axis = 0; axis < Dim; ++axis) {
      lower[axis] = static_cast<double>(bounds->min[axis]);
      upper[axis] = static_cast<double>(bounds->max[axis]);
    }
  }
  double extent = 0;
  for (int axis = 0; axis < Dim; ++axis) extent = std::max(extent, upper[axis] - lower[axis]);
  // Anything smaller runs into denormals on its way to cells.
  constexpr double kSmallestExtent = std::numeric_limits<double>::min() * 65536;
  if (!(extent >= kSmallestExtent && std::isfinite(extent))) return {};
  double size = extent;
  if (cell_size) {
    size = *cell_size;
  } else if (!points.empty()) {
    double small = std::clamp(grid_fit::smallest_cell(sample), extent / 65536, extent);
    double large = extent;
    std::vector<std::uint64_t> cells;
    // Bisection over the exponent: 12 halvings of at most 16 octaves leave the size within 1 %.
    for (int i = 0; i < 12 && large > 1.01 * small; ++i) {
      size = std::sqrt(small) * std::sqrt(large);  // the product could underflow or overflow
      (grid_fit::companions<Dim>(points, lower, size, objects, cells) > population ? large : small) = size;
    }
    size = small;
  }
  const auto too_large = [&] {
    double total = 1;
    double longest = 0;
    for (int axis = 0; axis < Dim; ++axis) {
      const double cells = std::max(1.0, std::ceil((upper[axis] - lower[axis]) / size));
      total *= cells;
      longest = std::max(longest, cells);
    }
    using Spec = GridSpec<Scalar, Dim>;
    // Empty cells cost memory: a derived grid has no more of them than objects, beyond a floor.
    const double limit = cell_size
                             ? static_cast<double>(Spec::kMaxCells)
                             : std::min(static_cast<double>(Spec::kMaxCells), 4096.0 + static_cast<double>(objects));
    return !(total <= limit && longest <= static_cast<double>(Spec::kMaxCellsPerAxis));
  };
  while (too_large()) size *= cell_size ? 2 : 1.25;
  return GridSpec<Scalar, Dim>(lower, upper, size);
}

}  // namespace sweepgrid
