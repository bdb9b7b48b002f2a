#include "engine_setting.hpp"

#include <charconv>

#include "cli/cell_names.hpp"

namespace sweepgrid::bench {
namespace {

constexpr std::string_view kDefaults = "engine";

// Both are left as they are by the name of the defaults, or none.
bool set_cell(std::string_view name, Config& config) {
  if (name == kDefaults) return true;
  const auto kinds = cell_kinds_by_name();
  const auto found = kinds.find(std::string(name));
  if (found == kinds.end()) return false;
  config.cell.kind = found->second;
  return true;
}

bool set_reduction(std::string_view name, Config& config) {
  if (name.empty()) return true;
  const auto reductions = reductions_by_name();
  const auto found = reductions.find(std::string(name));
  if (found == reductions.end()) return false;
  config.reduction = found->second;
  return true;
}

bool set_threads(std::string_view digits, Config& config) {
  config.threads = 1;
  if (digits.empty()) return true;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), config.threads);
  return error == std::errc() && config.threads > 0;
}

}  // namespace

std::optional<Config> engine_setting(std::string_view name) {
  const std::string_view words = name.substr(0, name.find_last_not_of("0123456789") + 1);
  const std::string_view cell = words.substr(0, words.find('-'));
  const std::string_view reduction = cell == words ? "" : words.substr(cell.size() + 1);
  Config config;
  if (!set_cell(cell, config) || !set_reduction(reduction, config)) return std::nullopt;
  if (!set_threads(name.substr(words.size()), config)) return std::nullopt;
  return config;
}

std::string engine_setting_help() {
  std::string cells(kDefaults);
  for (const auto& [name, kind] : cell_kinds_by_name()) cells += "|" + name;
  std::string reductions;
  for (const auto& [name, reduction] : reductions_by_name()) reductions += (reductions.empty() ? "" : "|") + name;
  return cells + "[-" + reductions + "][THREADS]";
}

}  // namespace sweepgrid::bench
