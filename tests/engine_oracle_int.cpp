#include <sweepgrid/engine/keyed_engine.inl.hpp>

#include "engine_oracle_play.hpp"

namespace sweepgrid::oracle {
namespace {

template <int Dim>
std::string play_kinds(const SceneRegime& regime) {
  std::size_t turn = 0;
  for (const CellKind kind : kKinds) {
    ++turn;
    // Only derived sizes: four dimensions have room for many cells.
    const GridChoice& grid = kGrids[turn % 3];
    const Reduction reduction = kReductions[(turn + Dim) / 2 % 2];
    const auto config = grid.config<Dim>(kind, make_executor(turn % 2 == 0 ? 1 : 3), reduction);
    const std::string wrong = play<std::int32_t, Dim>(config, SceneScript<std::int32_t, Dim>(regime, turn),
                                                      regime.steps, kCalls[turn % kCalls.size()]);
    if (!wrong.empty()) {
      return std::to_string(Dim) + " dimensions, " + kKindNames[turn - 1] + " cells, " + grid.name + ": " + wrong;
    }
  }
  return {};
}

}  // namespace

std::string play_int(const SceneRegime& regime) {
  const std::string wrong = play_kinds<1>(regime);
  return wrong.empty() ? play_kinds<4>(regime) : wrong;
}

}  // namespace sweepgrid::oracle
