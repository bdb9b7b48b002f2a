#include "setup/setup_json.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <nlohmann/json.hpp>

#include <sweepgrid/engine/config_json.hpp>
#include <sweepgrid/sap/quantizer.hpp>

#include "setup/json_text.hpp"

namespace sweepgrid {
namespace {

using Json = nlohmann::ordered_json;
using Members = JsonMembers<Json>;

constexpr const char* kSchema = "sweepgrid-setup";
constexpr int kSchemaVersion = 1;

enum class ScalarName { kDouble, kFloat, kInt32, kInt16 };
enum class RoundingName { kNone, kNearest, kOutward };

[[nodiscard]] const json_members::Names<ScalarName>& json_names(ScalarName) {
  static const json_members::Names<ScalarName> all = {{"double", ScalarName::kDouble},
                                                      {"float", ScalarName::kFloat},
                                                      {"int32", ScalarName::kInt32},
                                                      {"int16", ScalarName::kInt16}};
  return all;
}

[[nodiscard]] const json_members::Names<RoundingName>& json_names(RoundingName) {
  static const json_members::Names<RoundingName> all = {
      {"none", RoundingName::kNone}, {"nearest", RoundingName::kNearest}, {"outward", RoundingName::kOutward}};
  return all;
}

ScalarName scalar_of(Door door) {
  if (is_float(door)) return ScalarName::kFloat;
  if (door == Door::kDouble) return ScalarName::kDouble;
  return door == Door::kInt32 ? ScalarName::kInt32 : ScalarName::kInt16;
}

RoundingName rounding_of(Door door) {
  if (door == Door::kDouble) return RoundingName::kNone;
  return door == Door::kFloatNearest ? RoundingName::kNearest : RoundingName::kOutward;
}

// Absent, the rounding is what the type of numbers leaves; of float, to nearest.
Door read_door(Members& members, const Json& json) {
  ScalarName scalar = ScalarName::kFloat;
  members.read("scalar", scalar);
  std::optional<RoundingName> rounding;
  if (json.contains("rounding")) members.read("rounding", rounding.emplace());
  for (const Door door : {Door::kDouble, Door::kFloatNearest, Door::kFloatOutward, Door::kInt32, Door::kInt16}) {
    if (scalar_of(door) == scalar && rounding_of(door) == rounding.value_or(rounding_of(door))) return door;
  }
  members.refuse("rounding", json.at("rounding"),
                 scalar == ScalarName::kDouble  ? "\"none\" for double"
                 : scalar == ScalarName::kFloat ? "\"nearest\" or \"outward\" for float"
                                                : "\"outward\" for integers");
}

std::vector<std::size_t> read_axes(Members& members, const Json& json) {
  members.pass("axes");
  if (!json.contains("axes") || json.at("axes").is_null()) return {};
  const Json& given = json.at("axes");
  for (const std::vector<std::size_t>& known : {std::vector<std::size_t>{0, 1, 2}, {0, 1}, {0, 2}, {1, 2}}) {
    if (given == Json(known)) return known;
  }
  members.refuse("axes", given, "two or three of 0, 1 and 2, in this order");
}

void read_quantizer(const Json& json, Treatment& treatment) {
  Members members(json, "quantizer");
  members.read("resolution", treatment.resolution, false);
  members.pass("origin");
  members.finish();
  if (!json.contains("origin")) return;
  const Json& origin = json.at("origin");
  const bool good = origin.is_array() && origin.size() == 3 &&
                    std::all_of(origin.begin(), origin.end(), [](const Json& x) { return x.is_number(); });
  if (!good) members.refuse("origin", origin, "a list of three numbers");
  origin.get_to(treatment.origin);
  static_cast<void>(Quantizer<std::int32_t, 3>(treatment.origin, treatment.resolution));  // refuses what is no good
}

}  // namespace

std::string scalar_name(Door door) { return json_members::name_of(scalar_of(door)); }
std::string rounding_name(Door door) { return json_members::name_of(rounding_of(door)); }

Json setup_json(const EngineSetup& setup) {
  const Treatment& treatment = setup.treatment;
  Json json = {{"schema", kSchema},
               {"schema_version", kSchemaVersion},
               {"scalar", scalar_name(treatment.door)},
               {"rounding", rounding_name(treatment.door)},
               {"axes", treatment.axes.empty() ? Json(nullptr) : Json(treatment.axes)}};
  if (is_integer(treatment.door)) {
    json["quantizer"] = {{"origin", treatment.origin}, {"resolution", treatment.resolution}};
  }
  json["config"] = setup.config;
  return json;
}

EngineSetup setup_of(const Json& json) {
  Members members(json, "setup");
  members.pass("schema");
  members.pass("tune");
  if (const auto schema = json.find("schema"); schema != json.end() && *schema != kSchema) {
    members.refuse("schema", *schema, kSchema);
  }
  int version = kSchemaVersion;
  members.read("schema_version", version, 1);
  if (version != kSchemaVersion) {
    members.refuse("schema_version", json.at("schema_version"), std::to_string(kSchemaVersion));
  }
  EngineSetup setup;
  setup.treatment.door = read_door(members, json);
  setup.treatment.axes = read_axes(members, json);
  members.pass("quantizer");
  if (json.contains("quantizer") != is_integer(setup.treatment.door)) {
    throw std::invalid_argument("sweepgrid: setup::quantizer goes with integers, and integers with it");
  }
  if (json.contains("quantizer")) read_quantizer(json.at("quantizer"), setup.treatment);
  members.read("config", setup.config);
  members.finish();
  return setup;
}

EngineSetup read_setup(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw std::runtime_error(path + ": is a directory");
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  try {
    return setup_of(parse_json<Json>(file));
  } catch (const std::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

}  // namespace sweepgrid
