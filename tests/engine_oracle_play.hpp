#pragma once

#include <string>

#include "engine_oracle.hpp"

/// The matrices of the oracle test, a source file for each scalar and dimension so that they compile side by side.
/// All say what was wrong and with which settings; nothing when all was well.
namespace sweepgrid::oracle {

std::string play_matrix_f2(const SceneRegime& regime);
std::string play_matrix_f3(const SceneRegime& regime);
std::string play_matrix_d2(const SceneRegime& regime);
std::string play_matrix_d3(const SceneRegime& regime);
std::string play_int(const SceneRegime& regime);
std::string play_cell_script(const Regime& regime);
std::string play_large(int threads);

/// Every kind of cell with every thread count; grids and ways to call go round, so that each meets each.
template <class Scalar, int Dim>
std::string play_matrix(const SceneRegime& regime, std::size_t turn) {
  for (std::size_t t = 0; t < kThreadCounts.size(); ++t) {
    if (kSanitized && t % 2 == 0) continue;
    const std::shared_ptr<Executor> executor = make_executor(kThreadCounts[t]);
    for (std::size_t k = 0; k < kKinds.size(); ++k) {
      ++turn;
      std::size_t g = (turn + static_cast<std::size_t>(regime.steps)) % kGrids.size();
      while (regime.place == Place::kFarOut && !kGrids[g].bounded()) g = (g + 1) % kGrids.size();
      const Calls calls = kCalls[(turn + k) % kCalls.size()];
      const std::string wrong = play<Scalar, Dim>(kGrids[g].config<Scalar, Dim>(kKinds[k], executor),
                                                  SceneScript<Scalar, Dim>(regime, turn), regime.steps, calls);
      if (!wrong.empty()) {
        return std::string(regime.name) + ", " + kKindNames[k] + " cells, " + kGrids[g].name + ", " +
               std::to_string(kThreadCounts[t]) + " threads, calls " + std::to_string(static_cast<int>(calls)) +
               ", seed " + std::to_string(turn) + ": " + wrong;
      }
    }
  }
  return {};
}

}  // namespace sweepgrid::oracle
