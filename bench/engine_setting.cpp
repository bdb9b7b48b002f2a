#include "engine_setting.hpp"

#include <charconv>

#include "cli/cell_names.hpp"

namespace sweepgrid::bench {
namespace {

constexpr std::string_view kDefaults = "engine";

}  // namespace

std::optional<Config<float, 3>> engine_setting(std::string_view name) {
  const std::string_view kind = name.substr(0, name.find_last_not_of("0123456789") + 1);
  const std::string_view digits = name.substr(kind.size());
  Config<float, 3> config;
  config.threads = 1;
  if (!digits.empty()) {
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), config.threads);
    if (error != std::errc() || config.threads < 1) return std::nullopt;
  }
  if (kind == kDefaults) return config;
  const auto kinds = cell_kinds_by_name();
  const auto found = kinds.find(std::string(kind));
  if (found == kinds.end()) return std::nullopt;
  config.cell.kind = found->second;
  return config;
}

std::string engine_setting_names() {
  std::string names(kDefaults);
  for (const auto& [name, kind] : cell_kinds_by_name()) names += ", " + name;
  return names;
}

}  // namespace sweepgrid::bench
