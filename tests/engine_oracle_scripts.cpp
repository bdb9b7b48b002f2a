#include "engine_oracle_play.hpp"

namespace sweepgrid::oracle {
namespace {

template <class Scalar, int Dim>
std::string play_script(const Regime& regime, std::size_t turn) {
  for (const CellKind kind : kKinds) {
    ++turn;
    Config config;
    config.cell.kind = kind;
    config.cell_population = turn % 2 == 0 ? 2 : 20;
    config.threads = turn % 3 == 0 ? 3 : 1;
    config.parallel_from = turn % 2 == 0 ? 0 : 1000;
    config.reduction = kReductions[turn / 2 % 2];
    const std::string wrong =
        play<Scalar, Dim>(config, CellScript<Scalar, Dim>(regime, turn), regime.drains, kCalls[turn % kCalls.size()]);
    if (!wrong.empty()) return "seed " + std::to_string(turn) + ": " + wrong;
  }
  return {};
}

}  // namespace

std::string play_cell_script(const Regime& regime) {
  std::string wrong = play_script<float, 3>(regime, 0);
  if (wrong.empty()) wrong = play_script<double, 2>(regime, 1);
  return wrong;
}

// Enough objects that routing, gathering and merging are cut into several tasks as well, which few objects are not.
std::string play_large(int threads) {
  const int most = kSanitized ? 2600 : 5000;
  const std::shared_ptr<Executor> executor = make_executor(threads);
  const SceneRegime grow{.name = "Grow",
                         .population = 10,
                         .last_population = most,
                         .moving_percent = 50,
                         .churn_percent = 5,
                         .rebirth_percent = 2,
                         .mayfly_percent = 2,
                         .two_updates_percent = 5,
                         .steps = 9};
  const SceneRegime shrink{
      .name = "Shrink", .population = most, .last_population = 0, .moving_percent = 50, .churn_percent = 5, .steps = 6};
  for (const SceneRegime& regime : {grow, shrink}) {
    for (const CellKind kind : {CellKind::kRows, CellKind::kSegmented}) {
      for (const std::size_t g : {std::size_t{0}, std::size_t{3}}) {
        const Reduction reduction = kReductions[(g + (kind == CellKind::kRows ? 0 : 1)) % 2];
        const std::string wrong = play<float, 3>(kGrids[g].config<3>(kind, executor, reduction),
                                                 SceneScript<float, 3>(regime, g), regime.steps, kCalls[2 + g / 3]);
        if (!wrong.empty()) return std::string(regime.name) + ", " + kGrids[g].name + ": " + wrong;
      }
    }
  }
  return {};
}

}  // namespace sweepgrid::oracle
