#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "setup/engine_setup.hpp"

namespace sweepgrid {

/// "schema", "schema_version", "scalar", "rounding", "axes", "quantizer" (of integers) and "config": see
/// tools/README.md.
[[nodiscard]] nlohmann::ordered_json setup_json(const EngineSetup& setup);

/// And back; a member "tune" may hold anything. Throws std::invalid_argument that names a member which is unknown, or
/// whose value is out of range or does not go with another's.
[[nodiscard]] EngineSetup setup_of(const nlohmann::ordered_json& json);

/// Of a file. Throws std::runtime_error that names the file and what is wrong with it.
[[nodiscard]] EngineSetup read_setup(const std::string& path);

/// "double", "float", "int32", "int16"; and "none", "nearest", "outward".
[[nodiscard]] std::string scalar_name(Door door);
[[nodiscard]] std::string rounding_name(Door door);

}  // namespace sweepgrid
