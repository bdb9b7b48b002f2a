#pragma once

#include <map>
#include <string>

#include <sweepgrid/engine/config_json.hpp>

namespace sweepgrid {

/// The values of a setting as the command line calls them, which is as JSON does.
template <class Enum>
[[nodiscard]] std::map<std::string, Enum> by_name() {
  return {json_names(Enum{}).begin(), json_names(Enum{}).end()};
}

/// The kinds of cell.
[[nodiscard]] inline std::map<std::string, CellKind> cell_kinds_by_name() { return by_name<CellKind>(); }
[[nodiscard]] inline std::string cell_name(CellKind kind) { return json_members::name_of(kind); }

/// The ways from deltas to events.
[[nodiscard]] inline std::map<std::string, Reduction> reductions_by_name() { return by_name<Reduction>(); }
[[nodiscard]] inline std::map<std::string, StepMethod> step_methods_by_name() { return by_name<StepMethod>(); }
[[nodiscard]] inline std::string step_method_name(StepMethod method) { return json_members::name_of(method); }
[[nodiscard]] inline std::string reduction_name(Reduction reduction) { return json_members::name_of(reduction); }

}  // namespace sweepgrid
