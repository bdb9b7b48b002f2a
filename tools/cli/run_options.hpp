#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <sweepgrid/engine/config.hpp>
#include <sweepgrid/sap/cell_kind.hpp>

#include "scenes/open_scene.hpp"

namespace sweepgrid {

enum class ScalarKind { kFloat, kDouble };

/// What `sweepgrid run` was asked for. Absent: the engine's default.
struct RunOptions {
  std::vector<std::string> scenes;
  SceneOptions scene;
  int threads = 0;
  std::optional<CellKind> cell;
  std::optional<double> cell_size;
  std::optional<int> cell_population;
  std::optional<int> segment_capacity;
  std::optional<Reduction> reduction;
  ScalarKind scalar = ScalarKind::kFloat;
  std::optional<std::uint64_t> steps;  ///< at most so many after the start
  std::string events_path;             ///< empty: none
  std::string json_path;               ///< empty: none
  bool verify = false;
};

}  // namespace sweepgrid
