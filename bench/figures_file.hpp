#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace sweepgrid::bench {

/// Writes `figures`, an object, to `file`, behind what tells them from others: `schema` with its version, how the
/// program was built, and the machine. Throws std::runtime_error that names the file when it cannot be written.
void write_figures(const std::string& file, const std::string& schema, const nlohmann::ordered_json& figures);

}  // namespace sweepgrid::bench
