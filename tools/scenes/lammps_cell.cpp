#include "scenes/lammps_cell.hpp"

#include <algorithm>

namespace sweepgrid {

LammpsCell::LammpsCell(Kind kind, const std::array<std::array<double, 4>, 3>& numbers) {
  if (kind == Kind::kGeneral) {
    for (std::size_t edge = 0; edge < 3; ++edge) {
      std::copy_n(numbers[edge].begin(), 3, edges_[edge].begin());
      origin_[edge] = numbers[edge][3];
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bounds_.min[axis] = bounds_.max[axis] = origin_[axis];
      for (const auto& edge : edges_) (edge[axis] < 0 ? bounds_.min : bounds_.max)[axis] += edge[axis];
    }
  } else {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bounds_.min[axis] = numbers[axis][0];
      bounds_.max[axis] = numbers[axis][1];
    }
    // The bounds include what the tilt adds to the cell itself.
    const double xy = kind == Kind::kTriclinic ? numbers[0][2] : 0;
    const double xz = kind == Kind::kTriclinic ? numbers[1][2] : 0;
    const double yz = kind == Kind::kTriclinic ? numbers[2][2] : 0;
    const SceneBox tilt({std::min({0.0, xy, xz, xy + xz}), std::min(0.0, yz), 0},
                        {std::max({0.0, xy, xz, xy + xz}), std::max(0.0, yz), 0});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      origin_[axis] = bounds_.min[axis] - tilt.min[axis];
      edges_[axis][axis] = bounds_.max[axis] - tilt.max[axis] - origin_[axis];
    }
    edges_[1][0] = xy;
    edges_[2][0] = xz;
    edges_[2][1] = yz;
  }
  for (std::size_t edge = 0; edge < 3; ++edge) {
    for (std::size_t axis = 0; axis < 3; ++axis) tilted_ = tilted_ || (edge != axis && edges_[edge][axis] != 0);
  }
}

LammpsCell::Kind LammpsCell::kind_of(std::string_view words_behind_item) {
  if (words_behind_item.find("abc") != std::string_view::npos) return Kind::kGeneral;
  if (words_behind_item.find("xy") != std::string_view::npos) return Kind::kTriclinic;
  return Kind::kOrthogonal;
}

std::size_t LammpsCell::width_of(Kind kind) {
  if (kind == Kind::kGeneral) return 4;
  return kind == Kind::kTriclinic ? 3 : 2;
}

std::string_view LammpsCell::name_of(Kind kind, std::size_t place) {
  constexpr std::array<std::string_view, 3> kBounds = {"the low bound", "the high bound", "the tilt factor"};
  if (kind != Kind::kGeneral) return kBounds.at(place);
  return place < 3 ? "the edge" : "the origin";
}

}  // namespace sweepgrid
