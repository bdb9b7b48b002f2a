#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/lammps_cell.hpp"
#include "scenes/scene_source.hpp"

namespace sweepgrid {

/// What separates words in a dump.
inline constexpr std::string_view kBlanks = " \t";

/// Which columns of a dump's `ITEM: ATOMS` line make an object, and how.
class LammpsColumns {
 public:
  /// `names`: what follows `ITEM: ATOMS`. `diameter`: for dumps without a radius. `largest`: finite; see SceneOptions.
  /// Throws std::invalid_argument with the reason when the columns do not suffice.
  LammpsColumns(std::string_view names, std::optional<double> diameter, double largest);

  /// Throws std::invalid_argument when coordinates cannot be told from these columns in such a cell.
  void check_cell(const LammpsCell& cell) const;

  /// One line of atoms, in a cell that was checked. Throws std::invalid_argument with the reason when it is malformed
  /// or its box reaches too far.
  void read_atom(std::string_view line, const LammpsCell& cell, SceneKey& key, SceneBox& box);

  /// The id in a line that may be malformed elsewhere.
  [[nodiscard]] std::optional<SceneKey> id_of(std::string_view line);

  [[nodiscard]] const std::string& names() const { return names_; }
  /// The columns in use, for people: "id, x y z, radius".
  [[nodiscard]] std::string description() const;

 private:
  struct Position {
    std::string name;
    std::size_t column = 0;
    bool scaled = false;  // of the cell's edges
  };

  void find_positions(const std::vector<std::string_view>& columns);

  std::string names_;
  std::size_t count_ = 0;
  std::size_t id_ = 0;
  std::vector<Position> positions_;  // of x, y and, but for a dump of two dimensions, z
  std::optional<std::size_t> size_;  // the column of the radius or diameter
  double size_to_radius_ = 1;
  double default_radius_ = 0;
  double largest_;
  std::vector<std::string_view> words_;  // of the line being read
};

/// Words of a line, split at blanks and tabs.
void split_words(std::string_view line, std::vector<std::string_view>& words);

/// `line` without the blanks and tabs around it.
[[nodiscard]] std::string_view trim(std::string_view line);

/// The start of what a file holds, fit for a message: short and printable.
[[nodiscard]] std::string excerpt(std::string_view text);

/// The whole of `word` as a finite number, or as an unsigned one; std::invalid_argument names `what` otherwise.
[[nodiscard]] double parse_finite(std::string_view word, std::string_view what);
[[nodiscard]] std::uint64_t parse_unsigned(std::string_view word, std::string_view what);

}  // namespace sweepgrid
