// A small oracle test of the engine, quick to compile: `run` builds it anew for every planted bug.
// Exits with 1 and prints the name of each broken invariant when it notices something.

#include <algorithm>
#include <cstdint>
#include <iostream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <sweepgrid/engine/engine.hpp>
#include <sweepgrid/engine/engine_core.inl.hpp>

#include "op_script.hpp"
#include "scene_script.hpp"

namespace sweepgrid {

template class EngineCore<float, 2>;

namespace {

using TestEngine = Engine<float, 2>;
using KeyPair = std::pair<std::uint64_t, std::uint64_t>;
using Ops = oracle::EngineOps<float, 2>;

/// A client that believes the events, and a list of boxes that knows better.
class Client {
 public:
  void queue(TestEngine& engine, const Ops& ops) {
    for (const auto& op : ops) {
      if (op.kind == OpKind::kErase) {
        engine.erase(op.key);
        boxes_.erase(op.key);
        continue;
      }
      if (op.kind == OpKind::kInsert) {
        engine.insert(op.key, op.box);
      } else {
        engine.update(op.key, op.box);
      }
      boxes_.insert_or_assign(op.key, op.box);
    }
  }

  /// The name of a broken invariant and what broke it; empty if all is well. "oracle": no event tells of a change.
  std::string hear(const Events<std::uint64_t>& events) {
    const auto less = [](const auto& a, const auto& b) { return key_pair(a) < key_pair(b); };
    for (const auto* list : {&events.ends, &events.begins}) {
      const auto unordered =
          std::adjacent_find(list->begin(), list->end(), [&](const auto& a, const auto& b) { return !less(a, b); });
      if (unordered != list->end()) return "E3: not sorted and unique at " + text(key_pair(*unordered));
    }
    for (const auto& pair : events.ends) {
      if (known_.erase(key_pair(pair)) == 0) return "E2: an end without a begin: " + text(key_pair(pair));
    }
    for (const auto& pair : events.begins) {
      if (!known_.insert(key_pair(pair)).second) return "E2: begun twice: " + text(key_pair(pair));
    }
    std::set<KeyPair> truth;
    for (auto a = boxes_.begin(); a != boxes_.end(); ++a) {
      for (auto b = std::next(a); b != boxes_.end(); ++b) {
        if (a->second.overlaps(b->second)) truth.emplace(a->first, b->first);
      }
    }
    return truth == known_ ? "" : "oracle: the events do not lead to the overlaps of the boxes";
  }

 private:
  static KeyPair key_pair(const Pair<std::uint64_t>& pair) { return {pair.first, pair.second}; }
  static std::string text(const KeyPair& pair) {
    return "(" + std::to_string(pair.first) + ", " + std::to_string(pair.second) + ")";
  }

  std::map<std::uint64_t, Box<float, 2>> boxes_;
  std::set<KeyPair> known_;
};

std::string text_of(const std::exception& error) {
  const bool named = dynamic_cast<const InvariantError*>(&error) != nullptr;
  return (named ? "" : "oracle: exception: ") + std::string(error.what());
}

template <class Script>
int probe(const Config<float, 2>& config, const char* scene, Script script, int steps) {
  TestEngine engine(config);
  Client client;
  int status = 0;
  for (int step = 0; step < steps && status == 0; ++step) {
    const auto note = [&](const std::string& finding) {
      if (status == 0) std::cout << "scene " << scene << ", step " << step << '\n';
      std::cout << finding << '\n';
      status = 1;
    };
    try {
      client.queue(engine, script());
      const std::string finding = client.hear(engine.step());
      if (!finding.empty()) note(finding);
    } catch (const std::exception& error) {
      note(text_of(error));
    }
    // Said beside the client's finding: one names the invariant, the other sees from outside that events are wrong.
    try {
      engine.validate();
    } catch (const std::exception& error) {
      note(text_of(error));
    }
  }
  return status;
}

int probe_cells(const Config<float, 2>& config, const oracle::Regime& regime) {
  oracle::OpScript<float, 2> script(regime, 1);
  const auto next = [&] {
    Ops ops;
    for (const auto& op : script.next()) ops.push_back({op.kind, op.object, op.box});
    return ops;
  };
  return probe(config, regime.name, next, regime.drains);
}

int probe_scene(const Config<float, 2>& config, const oracle::SceneRegime& regime) {
  oracle::SceneScript<float, 2> script(regime, 1);
  return probe(
      config, regime.name, [&] { return script.next(); }, regime.steps);
}

Config<float, 2> config_of(CellKind kind, Reduction reduction, double cell_size) {
  Config<float, 2> config;
  config.threads = 1;
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

int probe_scenes() {
  const Config<float, 2> rows = config_of(CellKind::kRows, Reduction::kSingleReporter, 0);
  const Config<float, 2> batch = config_of(CellKind::kBatch, Reduction::kSingleReporter, 0);
  const Config<float, 2> fine = config_of(CellKind::kRows, Reduction::kSingleReporter, 1);
  for (const auto& regime : {kByTurns, kSizes, kGiants, kFollowed}) {
    if (probe_scene(rows, regime) != 0 || probe_scene(batch, regime) != 0) return 1;
  }
  return probe_scene(fine, kGiants) | probe_scene(fine, kFleeting);
}

int probe_all_cells() {
  const Config<float, 2> rows = config_of(CellKind::kRows, Reduction::kSingleReporter, 0);
  const Config<float, 2> batch = config_of(CellKind::kBatch, Reduction::kSingleReporter, 0);
  const Config<float, 2> counts = config_of(CellKind::kBatch, Reduction::kWitnessCounts, 0);
  const Config<float, 2> wide = config_of(CellKind::kSegmented, Reduction::kWitnessCounts, 500);
  const Config<float, 2> crowded = config_of(CellKind::kRows, Reduction::kWitnessCounts, 2);
  for (const oracle::Regime& regime : oracle::kRegimes) {
    for (const Config<float, 2>* config : {&rows, &batch, &counts, &wide, &crowded}) {
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
