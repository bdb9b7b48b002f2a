#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "scenes/scene_source.hpp"

namespace sweepgrid {

/// The simulation box of one frame of a dump: what `ITEM: BOX BOUNDS` and the three lines behind it tell. It is the
/// parallelepiped origin + a A + b B + c C with a, b and c from 0 to 1, which are the scaled coordinates of a point.
/// (LAMMPS's manual: dump command; Howto triclinic.)
class LammpsCell {
 public:
  /// The three kinds of box, by what `ITEM: BOX BOUNDS` is followed by.
  enum class Kind {
    kOrthogonal,  ///< "lo hi" on each line
    kTriclinic,   ///< "xy xz yz": "lo hi tilt" of the box that bounds the cell
    kGeneral,     ///< "abc origin": an edge's x, y, z and a coordinate of the origin
  };

  LammpsCell() = default;

  /// `numbers`: of the three lines, as many on each as `kind` has. Finite.
  LammpsCell(Kind kind, const std::array<std::array<double, 4>, 3>& numbers);

  [[nodiscard]] static Kind kind_of(std::string_view words_behind_item);
  /// Numbers on each line.
  [[nodiscard]] static std::size_t width_of(Kind kind);

  /// The name of the number that stands at `place` on a line.
  [[nodiscard]] static std::string_view name_of(Kind kind, std::size_t place);

  /// The axis-parallel box around the cell. Not valid where the file tells low bounds above the high ones.
  [[nodiscard]] const SceneBox& bounds() const { return bounds_; }
  /// Whether an edge leaves its axis, so that a coordinate needs all three scaled ones.
  [[nodiscard]] bool tilted() const { return tilted_; }
  /// Whether x and y depend on the third scaled coordinate.
  [[nodiscard]] bool leans() const { return edges_[2][0] != 0 || edges_[2][1] != 0; }
  /// The coordinate on one axis of the point with these scaled coordinates.
  [[nodiscard]] double unscale(const std::array<double, 3>& scaled, std::size_t axis) const {
    return origin_[axis] + scaled[0] * edges_[0][axis] + scaled[1] * edges_[1][axis] + scaled[2] * edges_[2][axis];
  }

 private:
  std::array<double, 3> origin_{};
  std::array<std::array<double, 3>, 3> edges_{};
  SceneBox bounds_{};
  bool tilted_ = false;
};

}  // namespace sweepgrid
