#pragma once

#include <map>
#include <string>

#include <sweepgrid/engine/config.hpp>
#include <sweepgrid/sap/cell_kind.hpp>

namespace sweepgrid {

/// The kinds of cell as the command line calls them.
[[nodiscard]] inline std::map<std::string, CellKind> cell_kinds_by_name() {
  return {{"auto", CellKind::kAuto},           {"rows", CellKind::kRows},       {"batch", CellKind::kBatch},
          {"segmented", CellKind::kSegmented}, {"classic", CellKind::kClassic}, {"plane", CellKind::kPlane}};
}

[[nodiscard]] inline std::string cell_name(CellKind kind) {
  for (const auto& [name, candidate] : cell_kinds_by_name()) {
    if (candidate == kind) return name;
  }
  return "?";
}

/// The ways from deltas to events as the command line calls them.
[[nodiscard]] inline std::map<std::string, Reduction> reductions_by_name() {
  return {{"reporter", Reduction::kSingleReporter}, {"counts", Reduction::kWitnessCounts}};
}

[[nodiscard]] inline std::string reduction_name(Reduction reduction) {
  return reduction == Reduction::kWitnessCounts ? "counts" : "reporter";
}

}  // namespace sweepgrid
