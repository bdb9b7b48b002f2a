#include "scenes/lammps_columns.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include <fmt/format.h>

namespace sweepgrid {
namespace {

// std::from_chars takes no plus.
std::string_view without_plus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  return word;
}

std::optional<std::size_t> find_column(const std::vector<std::string_view>& names, std::string_view name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  if (std::find(found + 1, names.end(), name) != names.end()) {
    throw std::invalid_argument(fmt::format("column '{}' is there twice", name));
  }
  return static_cast<std::size_t>(found - names.begin());
}

}  // namespace

void split_words(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  std::size_t begin = line.find_first_not_of(kBlanks);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
}

std::string_view trim(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return line.substr(begin, line.find_last_not_of(kBlanks) - begin + 1);
}

std::string excerpt(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string result(text.substr(0, kLongest));
  std::replace_if(
      result.begin(), result.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  if (text.size() > kLongest) result += "...";
  return result;
}

double parse_finite(std::string_view word, std::string_view what) {
  double value = 0;
  const std::string_view digits = without_plus(word);
  const char* const last = digits.data() + digits.size();
  const auto [end, error] = std::from_chars(digits.data(), last, value);
  if (end != last || error == std::errc::invalid_argument) {
    throw std::invalid_argument(fmt::format("{} is '{}', not a number", what, excerpt(word)));
  }
  // from_chars tells neither the value nor on which side it is out of range. What is too small is as good as zero.
  if (error == std::errc::result_out_of_range) value = std::strtod(std::string(digits).c_str(), nullptr);
  if (std::isfinite(value)) return value;
  const bool overflow = error == std::errc::result_out_of_range;
  throw std::invalid_argument(
      fmt::format("{} is '{}', {}", what, excerpt(word), overflow ? "out of the range of double" : "not finite"));
}

std::uint64_t parse_unsigned(std::string_view word, std::string_view what) {
  std::uint64_t value = 0;
  const std::string_view digits = without_plus(word);
  const char* const last = digits.data() + digits.size();
  const auto [end, error] = std::from_chars(digits.data(), last, value);
  if (error != std::errc() || end != last) {
    throw std::invalid_argument(fmt::format("{} is '{}', not a whole number of at most 64 bits", what, excerpt(word)));
  }
  return value;
}

LammpsColumns::LammpsColumns(std::string_view names, std::optional<double> diameter, double largest)
    : names_(names), largest_(largest) {
  std::vector<std::string_view> columns;
  split_words(names_, columns);
  count_ = columns.size();
  const auto id = find_column(columns, "id");
  if (!id) throw std::invalid_argument(fmt::format("no column 'id' among '{}'", excerpt(names_)));
  id_ = *id;
  find_positions(columns);
  size_ = find_column(columns, "radius");
  if (!size_) {
    size_ = find_column(columns, "diameter");
    size_to_radius_ = 0.5;
  }
  if (size_) return;
  if (!diameter) {
    throw std::invalid_argument(fmt::format(
        "no column 'radius' or 'diameter' among '{}', and no diameter given (--diameter)", excerpt(names_)));
  }
  default_radius_ = *diameter / 2;
}

void LammpsColumns::find_positions(const std::vector<std::string_view>& columns) {
  // Plain coordinates first: the others say the same less exactly, or count how often an atom went around.
  struct Form {
    std::string_view suffix;
    bool scaled;
  };
  constexpr std::array<Form, 4> kForms = {{{"", false}, {"u", false}, {"s", true}, {"su", true}}};
  const auto position = [&](char axis, const Form& form) -> std::optional<Position> {
    std::string name = fmt::format("{}{}", axis, form.suffix);
    const auto column = find_column(columns, name);
    if (!column) return std::nullopt;
    return Position{std::move(name), *column, form.scaled};
  };
  const auto first_form = [&](char axis) {
    for (const Form& form : kForms) {
      if (auto found = position(axis, form)) return found;
    }
    return std::optional<Position>();
  };
  // A dump of two dimensions has no z.
  const std::string_view axes = first_form('z') ? "xyz" : "xy";
  // All axes in one form where there is one, for the coordinates of a tilted cell depend on each other.
  for (const Form& form : kForms) {
    positions_.clear();
    for (const char axis : axes) {
      if (auto found = position(axis, form)) positions_.push_back(*std::move(found));
    }
    if (positions_.size() == axes.size()) return;
  }
  positions_.clear();
  for (const char axis : axes) {
    auto found = first_form(axis);
    if (!found) {
      throw std::invalid_argument(
          fmt::format("no column '{0}', '{0}u', '{0}s' or '{0}su' among '{1}'", axis, excerpt(names_)));
    }
    positions_.push_back(*std::move(found));
  }
}

void LammpsColumns::check_cell(const LammpsCell& cell) const {
  const auto scaled = [](const Position& position) { return position.scaled; };
  if (!cell.tilted() || std::none_of(positions_.begin(), positions_.end(), scaled)) return;
  if (!std::all_of(positions_.begin(), positions_.end(), scaled)) {
    throw std::invalid_argument(
        fmt::format("scaled and other coordinates in a tilted box among '{}'", excerpt(names_)));
  }
  if (positions_.size() < 3 && cell.leans()) {
    throw std::invalid_argument(
        fmt::format("no column 'zs' or 'zsu', which x and y depend on, among '{}'", excerpt(names_)));
  }
}

void LammpsColumns::read_atom(std::string_view line, const LammpsCell& cell, SceneKey& key, SceneBox& box) {
  split_words(line, words_);
  if (words_.size() != count_) {
    throw std::invalid_argument(
        fmt::format("{} values for the {} columns '{}'", words_.size(), count_, excerpt(names_)));
  }
  key = parse_unsigned(words_[id_], "the id");
  double radius = default_radius_;
  if (size_) radius = size_to_radius_ * parse_finite(words_[*size_], "the radius");
  if (radius < 0) throw std::invalid_argument(fmt::format("the radius is {}, negative", radius));
  std::array<double, 3> centre{};  // a dump without z has all atoms at z = 0
  std::array<double, 3> scaled{};
  for (std::size_t axis = 0; axis < positions_.size(); ++axis) {
    const Position& position = positions_[axis];
    (position.scaled ? scaled : centre)[axis] = parse_finite(words_[position.column], position.name);
  }
  for (std::size_t axis = 0; axis < positions_.size(); ++axis) {
    if (positions_[axis].scaled) centre[axis] = cell.unscale(scaled, axis);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.min[axis] = centre[axis] - radius;
    box.max[axis] = centre[axis] + radius;
    // Written so that a NaN is refused, too.
    if (box.min[axis] >= -largest_ && box.max[axis] <= largest_) continue;
    throw std::invalid_argument(fmt::format("the box on axis {}, from {} to {}, is not within -+ {}", "xyz"[axis],
                                            box.min[axis], box.max[axis], largest_));
  }
}

std::optional<SceneKey> LammpsColumns::id_of(std::string_view line) {
  split_words(line, words_);
  if (id_ >= words_.size()) return std::nullopt;
  try {
    return parse_unsigned(words_[id_], "the id");
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

std::string LammpsColumns::description() const {
  const std::string size =
      size_ ? (size_to_radius_ == 1 ? "radius" : "diameter") : fmt::format("diameter {} for all", 2 * default_radius_);
  std::string positions;
  for (const Position& position : positions_) positions += (positions.empty() ? "" : " ") + position.name;
  if (positions_.size() < 3) positions += " (z is 0)";
  return fmt::format("id, {}, {}", positions, size);
}

}  // namespace sweepgrid
