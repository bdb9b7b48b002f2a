#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <sweepgrid/grid/grid_spec.hpp>
#include <sweepgrid/sap/box.hpp>

namespace sweepgrid {

/// Derives a grid from a sample of boxes: bounds that hold nearly all centres, and the cell size at which an object has
/// about `population` others in its cell.
template <class Scalar, int Dim>
struct GridFit {
  /// Objects that one cell should hold.
  int population = 48;
  /// Given by the client, else derived. A grid that would have far more cells than objects leaves out more of the
  /// objects far away, which border cells then serve, and after that doubles the size.
  std::optional<double> cell_size;
  std::optional<Box<Scalar, Dim>> bounds;

  /// Boxes that suffice as a sample; more only cost time.
  static constexpr std::size_t kSample = 1 << 14;

  /// `sample` are boxes of evenly chosen objects, `objects` how many there are in all. O(sample log sample).
  [[nodiscard]] GridSpec<Scalar, Dim> derive(const std::vector<Box<Scalar, Dim>>& sample, std::size_t objects) const;
};

}  // namespace sweepgrid
