#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <sweepgrid/engine/config.hpp>

namespace sweepgrid::bench {

/// The engine's settings by a short name, CELL[-REDUCTION][THREADS]: "engine" is the engine as it comes, "batch" one
/// with that kind of cell, "batch-counts2" that with witness counts on two threads; without a number there is one
/// thread. Absent when there is no such kind or reduction.
[[nodiscard]] std::optional<Config> engine_setting(std::string_view name);

/// How names are made, with all kinds and reductions.
[[nodiscard]] std::string engine_setting_help();

}  // namespace sweepgrid::bench
