#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "system.hpp"

namespace sweepgrid::bench {

/// A system with its setting, by name.
struct Contestant {
  std::string name;
  std::string about;
  SystemMaker make;
  /// In a scene of more, a run takes minutes.
  std::uint32_t most_objects = std::numeric_limits<std::uint32_t>::max();
};

/// What the engine's contestants have in common. Absent: as the engine has it.
struct EngineOptions {
  std::optional<int> population;
  std::optional<int> segment_capacity;
  bool single_calls = false;
};

/// Other libraries, as far as they were there when this was built.
[[nodiscard]] std::vector<Contestant> peers();

/// One of the peers, or the engine in one of its settings; absent when there is none of that name.
[[nodiscard]] std::optional<Contestant> find_contestant(std::string_view name, const EngineOptions& options);

}  // namespace sweepgrid::bench
