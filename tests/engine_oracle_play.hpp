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

/// Every kind of cell with both reductions, with and without threads; grids and ways to call go round, so that each
/// meets each. Three kinds suffice to be tried with everything: two are but baselines, one is a choice of others.
template <class Scalar, int Dim>
std::string play_matrix(const SceneRegime& regime, std::size_t turn) {
  for (const int threads : {1, 4}) {
    if (kSanitized && threads == 1) continue;
    const std::shared_ptr<Executor> executor = make_executor(threads);
    for (std::size_t k = 0; k < kKinds.size(); ++k) {
      for (std::size_t r = 0; r < kReductions.size(); ++r) {
        ++turn;
        // Races are the same for all numbers: half of each, so that a kind meets a reduction in two dimensions or in
        // three.
        bool left_out = k >= 3 ? turn % 4 != 0 : kThreadSanitized && (turn + k) % 2 != 0;
        if (k < 3 && !kThreadSanitized && !plays_all()) left_out = (turn + k + first_turn(regime.name)) % 2 != 0;
        if (left_out) continue;
        std::size_t g = (turn + static_cast<std::size_t>(regime.steps)) % kGrids.size();
        while (!kGrids[g].suits(regime.place, kReductions[r])) g = (g + 1) % kGrids.size();
        const GridChoice& grid = kGrids[g];
        const Calls calls = kCalls[(turn + k) % kCalls.size()];
        const std::string wrong = play<Scalar, Dim>(grid.config<Dim>(kKinds[k], executor, kReductions[r]),
                                                    SceneScript<Scalar, Dim>(regime, turn), regime.steps, calls);
        if (!wrong.empty()) {
          return std::string(regime.name) + ", " + kKindNames[k] + " cells, " + kReductionNames[r] + ", " + grid.name +
                 ", " + std::to_string(threads) + " threads, calls " + std::to_string(static_cast<int>(calls)) +
                 ", seed " + std::to_string(turn) + ": " + wrong;
        }
      }
    }
  }
  return {};
}

}  // namespace sweepgrid::oracle
