#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <sweepgrid/grid/grid_spec.hpp>
#include <sweepgrid/sap/box.hpp>

namespace sweepgrid {

/// Derives a grid from a sample of boxes: where it lies, and the cell size at which an object has about `population`
/// others in its cell.
template <class Scalar, int Dim>
struct GridFit {
  /// Centres of other objects that the cell of an object should hold.
  double population = 6;
  /// Given by the client, else derived.
  std::optional<double> cell_size;

  /// What comes of it. Nearly all centres lie between the corners.
  struct Result {
    double cell_size = 1;
    std::array<double, Dim> lower{};
    std::array<double, Dim> upper{};
  };

  /// Boxes that suffice as a sample; more only cost time.
  static constexpr std::size_t kSample = 1 << 14;

  /// `sample` are boxes of evenly chosen objects, `objects` how many there are in all. O(sample log sample).
  [[nodiscard]] Result derive(const std::vector<Box<Scalar, Dim>>& sample, std::size_t objects) const;

  /// A grid of at most `cells` cells over the result; the cells at its border serve what lies outside. Doubles the cell
  /// size until it fits.
  [[nodiscard]] static GridSpec<Scalar, Dim> bounded(const Result& result, double cells);
};

}  // namespace sweepgrid
