#include "scenes/lammps_columns.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace sweepgrid {
namespace {

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
  constexpr std::string_view kBlanks = " \t";
  std::size_t begin = line.find_first_not_of(kBlanks);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
}

double parse_finite(std::string_view word, std::string_view what) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range) {
    throw std::invalid_argument(fmt::format("{} is '{}', out of the range of double", what, word));
  }
  if (error != std::errc() || end != word.data() + word.size()) {
    throw std::invalid_argument(fmt::format("{} is '{}', not a number", what, word));
  }
  if (!std::isfinite(value)) throw std::invalid_argument(fmt::format("{} is '{}', not finite", what, word));
  return value;
}

std::uint64_t parse_unsigned(std::string_view word, std::string_view what) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) {
    throw std::invalid_argument(fmt::format("{} is '{}', not a whole number of at most 64 bits", what, word));
  }
  return value;
}

LammpsColumns::LammpsColumns(std::string_view names, std::optional<double> diameter) : names_(names) {
  std::vector<std::string_view> columns;
  split_words(names_, columns);
  count_ = columns.size();
  const auto id = find_column(columns, "id");
  if (!id) throw std::invalid_argument(fmt::format("no column 'id' among '{}'", names_));
  id_ = *id;
  constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};
  // Plain coordinates first: the others say the same less exactly, or count how often an atom went around.
  struct Form {
    std::string_view suffix;
    bool scaled;
  };
  constexpr std::array<Form, 4> kForms = {{{"", false}, {"u", false}, {"s", true}, {"su", true}}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto column_of = [&](const Form& form) {
      return find_column(columns, fmt::format("{}{}", kAxes[axis], form.suffix));
    };
    const auto form = std::find_if(kForms.begin(), kForms.end(), column_of);
    if (form == kForms.end()) {
      throw std::invalid_argument(
          fmt::format("no column '{0}', '{0}u', '{0}s' or '{0}su' among '{1}'", kAxes[axis], names_));
    }
    position_[axis] = {*column_of(*form), form->scaled};
    position_name_[axis] = fmt::format("{}{}", kAxes[axis], form->suffix);
  }
  size_ = find_column(columns, "radius");
  if (!size_) {
    size_ = find_column(columns, "diameter");
    size_to_radius_ = 0.5;
  }
  if (size_) return;
  if (!diameter) {
    throw std::invalid_argument(
        fmt::format("no column 'radius' or 'diameter' among '{}', and no diameter given (--diameter)", names_));
  }
  default_radius_ = *diameter / 2;
}

void LammpsColumns::read_atom(std::string_view line, const LammpsBounds& bounds, SceneKey& key, SceneBox& box) {
  split_words(line, words_);
  if (words_.size() != count_) {
    throw std::invalid_argument(fmt::format("{} values for the {} columns '{}'", words_.size(), count_, names_));
  }
  key = parse_unsigned(words_[id_], "the id");
  double radius = default_radius_;
  if (size_) radius = size_to_radius_ * parse_finite(words_[*size_], "the radius");
  if (radius < 0) throw std::invalid_argument(fmt::format("the radius is {}, negative", radius));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double centre = parse_finite(words_[position_[axis].column], position_name_[axis]);
    if (position_[axis].scaled) {
      if (bounds.tilted) throw std::invalid_argument("scaled coordinates in a triclinic box are not supported");
      centre = bounds.low[axis] + centre * (bounds.high[axis] - bounds.low[axis]);
    }
    box.min[axis] = centre - radius;
    box.max[axis] = centre + radius;
  }
}

std::string LammpsColumns::description() const {
  const std::string size =
      size_ ? (size_to_radius_ == 1 ? "radius" : "diameter") : fmt::format("diameter {} for all", 2 * default_radius_);
  return fmt::format("id, {}, {}", fmt::join(position_name_, " "), size);
}

}  // namespace sweepgrid
