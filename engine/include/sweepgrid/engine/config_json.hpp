#pragma once

#include <cstdint>
#include <utility>

#include <nlohmann/json.hpp>

#include <sweepgrid/engine/config.hpp>
#include <sweepgrid/engine/envelope_options.hpp>
#include <sweepgrid/engine/json_members.hpp>
#include <sweepgrid/sap/cell_kind.hpp>

// Settings to and from JSON, by nlohmann-json: `Config config = json;`, `nlohmann::json json = config;`. For
// those who include this: nothing else of the library knows JSON.
//
// Members have the names that they have in the structs. What is absent has its default, and so have members of type
// std::optional that are null. A member that the struct has not, and a value out of its range, throw
// std::invalid_argument that names the member; nothing here recurses into what it does not know, however deeply JSON is
// nested. An executor has no JSON: what is read leaves it alone.
namespace sweepgrid {

// What values are called, in JSON as on command lines.

[[nodiscard]] inline const json_members::Names<CellKind>& json_names(CellKind) {
  static const json_members::Names<CellKind> all = {{"rows", CellKind::kRows},
                                                    {"batch", CellKind::kBatch},
                                                    {"segmented", CellKind::kSegmented},
                                                    {"classic", CellKind::kClassic},
                                                    {"plane", CellKind::kPlane}};
  return all;
}

[[nodiscard]] inline const json_members::Names<Integration>& json_names(Integration) {
  static const json_members::Names<Integration> all = {
      {"auto", Integration::kAuto}, {"one-by-one", Integration::kOneByOne}, {"presorted", Integration::kPresorted}};
  return all;
}

[[nodiscard]] inline const json_members::Names<Reduction>& json_names(Reduction) {
  static const json_members::Names<Reduction> all = {{"reporter", Reduction::kSingleReporter},
                                                     {"counts", Reduction::kWitnessCounts}};
  return all;
}

[[nodiscard]] inline const json_members::Names<StepMethod>& json_names(StepMethod) {
  static const json_members::Names<StepMethod> all = {
      {"auto", StepMethod::kAuto}, {"cells", StepMethod::kCells}, {"sweep", StepMethod::kSweep}};
  return all;
}

[[nodiscard]] inline const json_members::Names<OnViolation>& json_names(OnViolation) {
  static const json_members::Names<OnViolation> all = {{"report", OnViolation::kReport},
                                                       {"query", OnViolation::kQuery}};
  return all;
}

template <class BasicJson>
void to_json(BasicJson& json, const CellOptions& options) {
  json = {{"kind", json_members::name_of(options.kind)},
          {"segment_capacity", options.segment_capacity},
          {"integration", json_members::name_of(options.integration)}};
}

template <class BasicJson>
void from_json(const BasicJson& json, CellOptions& options) {
  options = {};
  JsonMembers<BasicJson> members(json, "CellOptions");
  members.read("kind", options.kind);
  members.read("segment_capacity", options.segment_capacity, 4, CellOptions::kMostSegmentCapacity);
  members.read("integration", options.integration);
  members.finish();
}

template <class BasicJson>
void to_json(BasicJson& json, const EnvelopeOptions& options) {
  json = {{"margin", options.margin},
          {"margin_steps", options.margin_steps},
          {"swept", options.swept},
          {"stride", options.stride},
          {"on_violation", json_members::name_of(options.on_violation)},
          {"exact", options.exact}};
}

template <class BasicJson>
void from_json(const BasicJson& json, EnvelopeOptions& options) {
  options = {};
  JsonMembers<BasicJson> members(json, "EnvelopeOptions");
  members.read("margin", options.margin, true);
  members.read("margin_steps", options.margin_steps, true);
  members.read("swept", options.swept);
  members.read("stride", options.stride, 1);
  members.read("on_violation", options.on_violation);
  members.read("exact", options.exact);
  members.finish();
  if (options.exact && options.swept) {
    members.refuse("exact", BasicJson(true), "false together with swept, which is about the way between steps");
  }
}

template <class BasicJson>
void to_json(BasicJson& json, const Config& config) {
  json = {{"cell", config.cell},
          {"cell_size", json_members::optional_json<BasicJson>(config.cell_size)},
          {"cell_population", json_members::optional_json<BasicJson>(config.cell_population)},
          {"reduction", json_members::name_of(config.reduction)},
          {"step_method", json_members::name_of(config.step_method)},
          {"envelope", json_members::optional_json<BasicJson>(config.envelope)},
          {"step_bytes", json_members::optional_json<BasicJson>(config.step_bytes)},
          {"threads", config.threads},
          {"parallel_from", config.parallel_from}};
}

template <class BasicJson>
void from_json(const BasicJson& json, Config& config) {
  Config read;
  read.executor = config.executor;
  JsonMembers<BasicJson> members(json, "Config");
  members.read("cell", read.cell);
  members.read("cell_size", read.cell_size, false);
  members.read("cell_population", read.cell_population, 1);
  members.read("reduction", read.reduction);
  members.read("step_method", read.step_method);
  members.read("envelope", read.envelope);
  members.read("step_bytes", read.step_bytes, std::uint64_t{0});
  members.read("threads", read.threads, 0, 65536);
  members.read("parallel_from", read.parallel_from, 0);
  members.finish();
  config = std::move(read);
}

}  // namespace sweepgrid
