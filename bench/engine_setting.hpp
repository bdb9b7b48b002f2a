#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <sweepgrid/engine/config.hpp>

namespace sweepgrid::bench {

/// The engine's settings by a short name: "engine" is the engine as it comes, "batch" one with that kind of cell, both
/// on one thread; a number behind the name is that of the threads. Absent when there is no such kind.
[[nodiscard]] std::optional<Config<float, 3>> engine_setting(std::string_view name);

/// The names, without numbers of threads: "engine, batch, ...".
[[nodiscard]] std::string engine_setting_names();

}  // namespace sweepgrid::bench
