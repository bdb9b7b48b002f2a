#pragma once

#include <nlohmann/json.hpp>

#include "rounds.hpp"
#include "system.hpp"

namespace sweepgrid::bench {

/// A row for each contestant on stdout, then the first complaint about each.
void print_table(const Rounds& rounds);

/// An array with an object for each contestant.
[[nodiscard]] nlohmann::ordered_json to_json(const Rounds& rounds);

}  // namespace sweepgrid::bench
