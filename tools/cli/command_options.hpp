#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "cli/number_text.hpp"
#include "scenes/open_scene.hpp"

namespace sweepgrid {

/// As many threads as an option may ask for; as many as make_executor() takes.
inline constexpr int kMostThreads = 65536;

/// Hands the number in `text` to `take`; "auto" leaves what was there.
template <class Number, class Take>
void take_number(const std::string& name, const std::string& text, const NumberRange<Number>& range, const Take& take) {
  try {
    if (const auto number = number_of(text, range)) take(*number);
  } catch (const std::invalid_argument& error) {
    throw CLI::ValidationError(name, error.what());
  }
}

/// Adds an option that takes a number of a range as number_of() reads it; CLI11 itself takes 010 for 8, NaN for a
/// number within any bounds, and the greatest number for all that are greater. Anything else is refused with the
/// option, the text and the range.
template <class Number, class Take>
CLI::Option* add_number(CLI::App& command, const std::string& name, const NumberRange<Number>& range, Take take,
                        const std::string& description) {
  const auto read = [name, range, take = std::move(take)](const std::string& text) {
    take_number(name, text, range, take);
  };
  return command.add_option_function<std::string>(name, read, description)->type_name(range.auto_too ? "auto|N" : "N");
}

/// As above, several numbers, between commas.
template <class Number, class Take>
CLI::Option* add_numbers(CLI::App& command, const std::string& name, const NumberRange<Number>& range, Take take,
                         const std::string& description) {
  const auto read = [name, range, take = std::move(take)](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) take_number(name, text, range, take);
  };
  return command.add_option_function<std::vector<std::string>>(name, read, description)
      ->delimiter(',')
      ->type_name("N,...");
}

/// Adds an option that takes one of some names; CLI11's own transformers take the numbers behind them, too.
template <class Value, class Take>
CLI::Option* add_choice(CLI::App& command, const std::string& name, const std::map<std::string, Value>& values,
                        Take take, const std::string& description) {
  std::vector<std::string> names;
  names.reserve(values.size());
  for (const auto& [known, value] : values) names.push_back(known);
  const auto read = [name, values, names, take = std::move(take)](const std::string& text) {
    const auto found = values.find(text);
    if (found != values.end()) return take(found->second);
    throw CLI::ValidationError(name, fmt::format("'{}' is none of {}", text, fmt::join(names, ", ")));
  };
  return command.add_option_function<std::string>(name, read, description)
      ->type_name(fmt::format("{}", fmt::join(names, "|")));
}

/// Adds an option that takes the path of a file.
inline CLI::Option* add_file(CLI::App& command, const std::string& name, std::string& path,
                             const std::string& description) {
  return command.add_option(name, path, description)
      ->type_name("FILE")
      ->check(CLI::Validator([](std::string& text) { return std::string(text.empty() ? "names no file" : ""); }, ""));
}

/// Adds --diameter.
inline CLI::Option* add_diameter(CLI::App& command, SceneOptions& scene) {
  return add_number(
      command, "--diameter", NumberRange<double>(), [&scene](double diameter) { scene.diameter = diameter; },
      "Of the atoms of a dump without a column for it");
}

}  // namespace sweepgrid
