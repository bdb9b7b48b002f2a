#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <sweepgrid/grid/grid_spec.hpp>
#include <sweepgrid/sap/box.hpp>

namespace sweepgrid {

/// Derives a grid from a sample of boxes: where it lies, and the size of its cells.
///
/// Small cells hold few objects to compare with, but then a box lies in more of them. Either the client says how many
/// objects a cell should hold, or the cost of an op is minimised: the number of cells that it goes to, times what a
/// cell costs by itself and for each of its residents.
template <class Scalar, int Dim>
struct GridFit {
  /// Given by the client, else derived.
  std::optional<double> cell_size;
  /// Centres of other objects that the cell of an object should hold; absent: what costs least.
  std::optional<double> population;
  /// What an op costs in a cell without residents, in units of what each resident adds.
  double cell_overhead = 90;

  /// What comes of it. Nearly all centres lie between the corners.
  struct Result {
    double cell_size = 1;
    double met = 1;  // residents that an op is expected to meet in a cell
    std::array<double, Dim> lower{};
    std::array<double, Dim> upper{};

    /// Part of the space between the corners that lies between those of another result.
    [[nodiscard]] double share_within(const Result& other) const {
      double share = 1;
      for (int axis = 0; axis < Dim; ++axis) {
        const double common = std::min(upper[axis], other.upper[axis]) - std::max(lower[axis], other.lower[axis]);
        const double edge = upper[axis] - lower[axis];
        share *= common < 0 ? 0 : edge > 0 ? common / edge : 1;
      }
      return share;
    }
  };

  /// Boxes that suffice as a sample of so many objects; more only cost time.
  [[nodiscard]] static std::size_t sample_size(std::size_t objects) {
    return std::clamp<std::size_t>(objects / 16, 512, 4096);
  }

  /// `sample` are boxes of evenly chosen objects, `objects` how many there are in all. O(sample log sample).
  [[nodiscard]] Result derive(const std::vector<Box<Scalar, Dim>>& sample, std::size_t objects) const;

  /// A grid of at most `cells` cells over the result; the cells at its border serve what lies outside. Doubles the cell
  /// size until it fits.
  [[nodiscard]] static GridSpec<Scalar, Dim> bounded(const Result& result, double cells);
};

}  // namespace sweepgrid
