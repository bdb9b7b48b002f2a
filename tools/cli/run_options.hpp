#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <sweepgrid/engine/config.hpp>
#include <sweepgrid/sap/cell_kind.hpp>

#include "scenes/open_scene.hpp"
#include "setup/engine_setup.hpp"

namespace sweepgrid {

enum class ScalarKind { kFloat, kDouble };

/// What `sweepgrid run` was asked for. Absent: the engine's default.
struct RunOptions {
  std::vector<std::string> scenes;
  SceneOptions scene;
  std::optional<int> threads;        ///< wins over those of `setup`; absent from both: all cores
  std::string config_path;           ///< of `setup`; empty: none
  std::optional<EngineSetup> setup;  ///< goes with none of the next six
  std::optional<CellKind> cell;
  std::optional<double> cell_size;
  std::optional<int> cell_population;
  std::optional<int> segment_capacity;
  std::optional<Reduction> reduction;
  std::optional<StepMethod> step_method;
  ScalarKind scalar = ScalarKind::kFloat;
  std::optional<std::uint64_t> steps;  ///< at most so many after the start
  std::string events_path;             ///< empty: none
  std::string json_path;               ///< empty: none
  bool verify = false;

  [[nodiscard]] int thread_count() const { return threads.value_or(setup ? setup->config.threads : 0); }
};

/// The setup that was asked for, by the file or by the other options.
[[nodiscard]] EngineSetup setup_of(const RunOptions& options);

}  // namespace sweepgrid
