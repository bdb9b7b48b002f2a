#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sweepgrid::bench {

/// A scene by the name that tables give it.
struct NamedScene {
  std::string name;
  std::string scene;  ///< as open_scene() takes it
};

/// What the library is judged by: the paper's workload and those that hurt broad phases.
[[nodiscard]] std::vector<NamedScene> standard_scenes();

/// The same with 1e5 to 1e6 objects, in fewer steps, as scripts are held in memory.
[[nodiscard]] std::vector<NamedScene> large_scenes();

/// One scene of `objects` objects of every sort that the standard scenes have.
[[nodiscard]] std::vector<NamedScene> small_scenes(std::uint64_t objects, std::uint64_t steps);

/// Every file in `directory` but texts about them (*.md), by name. Throws std::filesystem::filesystem_error.
[[nodiscard]] std::vector<NamedScene> recordings(const std::string& directory);

}  // namespace sweepgrid::bench
