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

/// The space that a grid divides.
template <int Dim>
struct Extent {
  std::array<double, Dim> lower{};
  std::array<double, Dim> upper{};

  [[nodiscard]] double longest() const {
    double longest = 0;
    for (int axis = 0; axis < Dim; ++axis) longest = std::max(longest, upper[axis] - lower[axis]);
    return longest;
  }
};

// Between quantiles, so that objects far away (a part of `tail` on each side) do not stretch the grid over empty space.
template <int Dim>
Extent<Dim> extent_of(const Points<Dim>& points, double tail) {
  Extent<Dim> extent;
  if (points.empty()) return extent;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < Dim; ++axis) {
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][axis];
    const auto skipped = static_cast<std::size_t>(tail * static_cast<double>(points.size()));
    std::sort(values.begin(), values.end());
    extent.lower[axis] = values[skipped];
    extent.upper[axis] = values[points.size() - 1 - skipped];
    const double slack = (extent.upper[axis] - extent.lower[axis]) * 0.02;
    extent.lower[axis] -= slack, extent.upper[axis] += slack;
  }
  return extent;
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

// Cells that the average box is in, of this size. Boxes that are wider live in coarser grids.
template <class Scalar, int Dim>
double copies(const std::vector<Box<Scalar, Dim>>& sample, double size) {
  double total = 0;
  for (const auto& box : sample) {
    double cells = 1;
    for (int axis = 0; axis < Dim; ++axis) {
      const double edge = static_cast<double>(box.max[axis]) - static_cast<double>(box.min[axis]);
      cells *= 1 + std::min(1.0, edge / size);
    }
    total += cells;
  }
  return total / static_cast<double>(sample.size());
}

/// A sample of a scene, and what cells of some size would hold.
template <class Scalar, int Dim>
struct Census {
  const std::vector<Box<Scalar, Dim>>& sample;
  const Points<Dim>& points;
  const Extent<Dim>& extent;
  std::size_t objects;
  std::vector<std::uint64_t> scratch;

  [[nodiscard]] double companions(double size) {
    return grid_fit::companions<Dim>(points, extent.lower, size, objects, scratch);
  }
  [[nodiscard]] double met(double size) { return companions(size) * copies(sample, size); }
  [[nodiscard]] double cost(double size, double overhead) { return copies(sample, size) * (overhead + met(size)); }
};

// The largest size at which an object has at most `population` companions, or nearly twice the width of most boxes.
template <class Scalar, int Dim>
double size_for_population(Census<Scalar, Dim>& census, double population) {
  double large = census.extent.longest();
  double small = std::clamp(smallest_cell(census.sample), large / 65536, large);
  // Bisection over the exponent: 9 halvings of at most 16 octaves leave the size within 3 %.
  for (int i = 0; i < 9 && large > 1.03 * small; ++i) {
    const double size = std::sqrt(small) * std::sqrt(large);  // the product could underflow or overflow
    (census.companions(size) > population ? large : small) = size;
  }
  return small;
}

// From a size that is about right, downhill.
template <class Scalar, int Dim>
double cheapest_size(Census<Scalar, Dim>& census, double overhead) {
  // Cells not much wider than boxes send them to coarser grids, which the model does not know.
  const double usual = smallest_cell(census.sample);
  const double largest = census.extent.longest();
  if (largest <= usual) return usual;  // all are in one another's reach: cells divide nothing, and keep their size
  const double smallest = 0.65 * usual;
  double best = std::max(smallest, size_for_population(census, 12));
  double least = census.cost(best, overhead);
  for (const double factor : {1.25, 0.8}) {
    const double start = best;
    for (double size = best * factor; size >= smallest && size <= largest; size *= factor) {
      const double cost = census.cost(size, overhead);
      if (!(cost < least)) break;
      best = size, least = cost;
    }
    if (best != start) break;
  }
  return best;
}

}  // namespace grid_fit

template <class Scalar, int Dim>
auto GridFit<Scalar, Dim>::derive(const std::vector<Box<Scalar, Dim>>& sample, std::size_t objects) const -> Result {
  const auto points = grid_fit::centres(sample);
  const auto extent = grid_fit::extent_of<Dim>(points, 0.005);
  grid_fit::Census<Scalar, Dim> census{sample, points, extent, objects, {}};
  Result result;
  result.lower = extent.lower;
  result.upper = extent.upper;
  // Anything smaller runs into denormals on its way to cells.
  constexpr double kSmallestExtent = std::numeric_limits<double>::min() * 65536;
  const bool sound = extent.longest() >= kSmallestExtent && std::isfinite(extent.longest());
  if (cell_size) {
    result.cell_size = *cell_size;
  } else if (sound) {
    result.cell_size = population ? grid_fit::size_for_population(census, *population)
                                  : grid_fit::cheapest_size(census, cell_overhead);
  } else if (const double width = grid_fit::smallest_cell(sample); width >= kSmallestExtent) {
    result.cell_size = width;
  }
  if (!sound) result.upper = result.lower;
  if (sound && !cell_size) result.met = std::max(1.0, census.met(result.cell_size));
  return result;
}

template <class Scalar, int Dim>
GridSpec<Scalar, Dim> GridFit<Scalar, Dim>::bounded(const Result& result, double cells) {
  for (double size = result.cell_size;; size *= 2) {
    CellCoordinates<Dim> limit;
    double total = 1;
    for (int axis = 0; axis < Dim; ++axis) {
      const double count = std::max(1.0, std::ceil((result.upper[axis] - result.lower[axis]) / size));
      total *= count;
      limit[axis] = static_cast<std::uint32_t>(std::min(count - 1, double{CellCode<Dim>::kLastCoordinate}));
    }
    if (total <= cells) return GridSpec<Scalar, Dim>(size, result.lower, limit);
  }
}

}  // namespace sweepgrid
