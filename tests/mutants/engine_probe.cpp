// A small oracle test of steps that go through cells, quick to compile: `run` builds it anew for every planted bug.
// Exits with 1 and prints the name of each broken invariant when it notices something.

#include <cstddef>
#include <cstdint>
#include <exception>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "op_script.hpp"
#include "play.hpp"
#include "scene_script.hpp"

namespace sweepgrid {
namespace {

int probe_cells(const Config& config, const oracle::Regime& regime) {
  oracle::OpScript<float, 2> script(regime, 1);
  const auto next = [&] {
    Ops ops;
    for (const auto& op : script.next()) ops.push_back({op.kind, op.object, op.box});
    return ops;
  };
  return probe(config, regime.name, next, regime.drains);
}

Config config_of(CellKind kind, Reduction reduction, double cell_size) {
  Config config;
  config.step_method = StepMethod::kCells;  // small scenes would be swept
  if (kind == CellKind::kBatch) {
    config.executor = std::make_shared<Backwards>();
    config.parallel_from = 0;
  } else {
    config.threads = 1;
  }
  config.cell.kind = kind;
  config.cell.segment_capacity = 8;
  config.reduction = reduction;
  config.cell_population = 8;
  if (cell_size > 0) config.cell_size = cell_size;
  return config;
}

/// Outgrows its cells while few move, so that most objects are carried from grid to grid as they rest.
constexpr oracle::SceneRegime kFollowed{.name = "Followed",
                                        .place = oracle::Place::kSizes,
                                        .population = 12,
                                        .last_population = 600,
                                        .moving_percent = 5,
                                        .churn_percent = 2,
                                        .steps = 12};
constexpr oracle::SceneRegime kSizes{
    .name = "Sizes", .place = oracle::Place::kSizes, .travel = oracle::Travel::kResize, .churn_percent = 5};
constexpr oracle::SceneRegime kByTurns{.name = "ByTurns", .churn_percent = 5, .alternates = true, .steps = 8};
constexpr oracle::SceneRegime kGiants{
    .name = "Giants", .place = oracle::Place::kGiants, .moving_percent = 30, .churn_percent = 5};
constexpr oracle::SceneRegime kFleeting{
    .name = "Fleeting", .population = 200, .moving_percent = 20, .churn_percent = 40};

/// Many come at once, and few move: everybody else is carried to the new cells, a slice in each step.
int probe_following(Config config) {
  config.executor = std::make_shared<Backwards>();
  config.parallel_from = 0;
  TestEngine engine(config);
  Client client;
  oracle::Random random(1);
  const auto box = [&](float size) {
    const float x = size * static_cast<float>(random.below(10'000)) / 10'000;
    const float y = size * static_cast<float>(random.below(10'000)) / 10'000;
    return Box<float, 2>({x, y}, {x + 0.5F, y + 0.5F});
  };
  const auto play = [&](int number, const Ops& ops, double cell_size) {
    std::vector<std::string> findings = step(engine, client, ops);
    const Stats stats = engine.stats();
    if (cell_size > 0 && stats.grids != 1) {
      findings.push_back("follow: objects are left in grids of old: there are " + std::to_string(stats.grids));
    }
    if (cell_size > 0 && stats.cell_size > cell_size) {
      findings.push_back("follow: cells are still " + std::to_string(stats.cell_size) + " wide");
    }
    if (number == 1 && stats.step.regrids != 1) findings.push_back("follow: many have come, and nothing follows");
    return findings.empty() ? 0 : report("Following", number, findings);
  };
  constexpr std::uint64_t kFew = 60;
  constexpr std::uint64_t kMany = 1500;
  Ops ops;
  const auto put = [&](OpKind kind, std::uint64_t first, std::uint64_t end, float size) {
    for (std::uint64_t key = first; key < end; ++key) ops.push_back({kind, key, box(size)});
  };
  put(OpKind::kInsert, 0, kFew, 100);
  if (play(0, ops, 0) != 0) return 1;
  const double first_size = engine.stats().cell_size;
  for (int number = 1; number < 14; ++number) {
    ops.clear();
    if (number == 1) put(OpKind::kInsert, kFew, kMany, 100);
    put(OpKind::kUpdate, 0, kFew, 100);
    if (number > 3) ops.push_back({OpKind::kErase, kMany - static_cast<std::uint64_t>(number), {}});
    if (play(number, ops, number == 13 ? first_size / 1.3 : 0) != 0) return 1;
  }
  const double second_size = engine.stats().cell_size;
  for (int number = 14; number < 26; ++number) {  // all move into a corner
    ops.clear();
    put(OpKind::kUpdate, 0, number < 16 ? kMany - 13 : kFew, 12);
    if (play(number, ops, number == 25 ? second_size / 1.25 : 0) != 0) return 1;
  }
  return 0;
}

int probe_scenes() {
  const Config rows = config_of(CellKind::kRows, Reduction::kSingleReporter, 0);
  const Config batch = config_of(CellKind::kBatch, Reduction::kSingleReporter, 0);
  const Config fine = config_of(CellKind::kRows, Reduction::kSingleReporter, 1);
  const Config counts = config_of(CellKind::kRows, Reduction::kWitnessCounts, 0);
  if (probe_refusals(rows, kFleeting) != 0 || probe_refusals(batch, kSizes) != 0) return 1;
  if (probe_refusals(counts, kFleeting) != 0 || probe_scene(counts, kFollowed) != 0) return 1;
  if (probe_following(config_of(CellKind::kRows, Reduction::kSingleReporter, 0)) != 0) return 1;
  for (const auto& regime : {kByTurns, kSizes, kGiants, kFollowed}) {
    if (probe_scene(rows, regime) != 0 || probe_scene(batch, regime) != 0) return 1;
  }
  return probe_scene(fine, kGiants) != 0 || probe_scene(fine, kFleeting) != 0 ? 1 : 0;
}

int probe_all_cells() {
  const Config rows = config_of(CellKind::kRows, Reduction::kSingleReporter, 0);
  const Config batch = config_of(CellKind::kBatch, Reduction::kSingleReporter, 0);
  const Config counts = config_of(CellKind::kBatch, Reduction::kWitnessCounts, 0);
  const Config wide = config_of(CellKind::kSegmented, Reduction::kWitnessCounts, 500);
  const Config crowded = config_of(CellKind::kRows, Reduction::kWitnessCounts, 2);
  for (const oracle::Regime& regime : oracle::kRegimes) {
    for (const Config* config : {&rows, &batch, &counts, &wide, &crowded}) {
      if (config == &wide && regime.palette != oracle::Palette::kFine) continue;
      if (config == &crowded && regime.palette != oracle::Palette::kLattice) continue;
      if (probe_cells(*config, regime) != 0) return 1;
    }
  }
  return 0;
}

}  // namespace
}  // namespace sweepgrid

int main() { return sweepgrid::probe_scenes() != 0 || sweepgrid::probe_all_cells() != 0 ? 1 : 0; }
