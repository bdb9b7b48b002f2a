#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/scene_source.hpp"

namespace sweepgrid {

/// The `BOX BOUNDS` of one frame of a dump.
struct LammpsBounds {
  std::array<double, 3> low{};
  std::array<double, 3> high{};
  bool tilted = false;  ///< a triclinic box
};

/// Which columns of a dump's `ITEM: ATOMS` line make an object, and how.
class LammpsColumns {
 public:
  /// `names`: what follows `ITEM: ATOMS`. `diameter`: for dumps without a radius.
  /// Throws std::invalid_argument with the reason when the columns do not suffice.
  LammpsColumns(std::string_view names, std::optional<double> diameter);

  /// One line of atoms. Throws std::invalid_argument with the reason when it is malformed.
  void read_atom(std::string_view line, const LammpsBounds& bounds, SceneKey& key, SceneBox& box);

  [[nodiscard]] const std::string& names() const { return names_; }
  /// The columns in use, for people: "id, x y z, radius".
  [[nodiscard]] std::string description() const;

 private:
  struct Position {
    std::size_t column = 0;
    bool scaled = false;  // 0 at the low bound and 1 at the high bound
  };

  std::string names_;
  std::size_t count_ = 0;
  std::size_t id_ = 0;
  std::array<Position, 3> position_;
  std::array<std::string, 3> position_name_;
  std::optional<std::size_t> size_;  // the column of the radius or diameter
  double size_to_radius_ = 1;
  double default_radius_ = 0;
  std::vector<std::string_view> words_;  // of the line being read
};

/// Words of a line, split at blanks and tabs.
void split_words(std::string_view line, std::vector<std::string_view>& words);

/// The whole of `word` as a finite number, or as an unsigned one; std::invalid_argument names `what` otherwise.
[[nodiscard]] double parse_finite(std::string_view word, std::string_view what);
[[nodiscard]] std::uint64_t parse_unsigned(std::string_view word, std::string_view what);

}  // namespace sweepgrid
