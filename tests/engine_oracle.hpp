#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <sweepgrid/engine/engine.hpp>

#include "engine_model.hpp"
#include "op_script.hpp"
#include "sanitized.hpp"
#include "scene_script.hpp"

/// Engines beside the brute-force oracle: the settings to try, the ways to queue one and the same step, and the play.
namespace sweepgrid::oracle {

/// Ways to queue the same ops.
enum class Calls { kByKey, kByHandle, kBulk, kFourThreads };
inline constexpr std::array kCalls{Calls::kByKey, Calls::kByHandle, Calls::kBulk, Calls::kFourThreads};

template <class Scalar, int Dim>
void queue_one(Engine<Scalar, Dim>& engine, const EngineOp<Scalar, Dim>& op) {
  if (op.kind == OpKind::kInsert) engine.insert(op.key, op.box);
  if (op.kind == OpKind::kUpdate) engine.update(op.key, op.box);
  if (op.kind == OpKind::kErase) engine.erase(op.key);
}

/// Ops [first, end), all of one kind, in one call.
template <class Scalar, int Dim>
void queue_bulk(Engine<Scalar, Dim>& engine, std::span<const EngineOp<Scalar, Dim>> ops) {
  std::vector<std::uint64_t> keys;
  std::vector<Handle> handles;
  std::vector<Box<Scalar, Dim>> boxes;
  for (const auto& op : ops) {
    keys.push_back(op.key);
    boxes.push_back(op.box);
    if (op.kind != OpKind::kInsert) handles.push_back(engine.find(op.key).value());
  }
  if (ops[0].kind == OpKind::kInsert) engine.insert(keys, boxes);
  if (ops[0].kind == OpKind::kUpdate) engine.update(handles, boxes);
  if (ops[0].kind == OpKind::kErase) engine.erase(handles);
}

template <class Scalar, int Dim>
void queue(Engine<Scalar, Dim>& engine, const EngineOps<Scalar, Dim>& ops, Calls calls) {
  if (calls == Calls::kByKey) {
    for (const auto& op : ops) queue_one(engine, op);
  } else if (calls == Calls::kByHandle) {
    for (const auto& op : ops) {
      if (op.kind == OpKind::kInsert) engine.insert(op.key, op.box);
      if (op.kind == OpKind::kUpdate) engine.update(engine.find(op.key).value(), op.box);
      if (op.kind == OpKind::kErase) engine.erase(engine.find(op.key).value());
    }
  } else if (calls == Calls::kBulk) {
    for (std::size_t first = 0, end = 0; first < ops.size(); first = end) {
      while (end < ops.size() && ops[end].kind == ops[first].kind) ++end;
      queue_bulk(engine, std::span(ops).subspan(first, end - first));
    }
  } else {
    std::vector<std::thread> threads;
    for (std::uint64_t own = 0; own < 4; ++own) {
      threads.emplace_back([&engine, &ops, own] {
        for (const auto& op : ops) {
          if (op.key % 4 == own) queue_one(engine, op);
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  }
}

/// The ops in another order that means the same: those of one key stay in theirs.
template <class Scalar, int Dim>
EngineOps<Scalar, Dim> shuffled(const EngineOps<Scalar, Dim>& ops, std::uint64_t seed) {
  Random random(seed);
  std::map<std::uint64_t, std::vector<std::size_t>> by_key;
  std::vector<std::uint64_t> order;
  for (std::size_t i = 0; i < ops.size(); ++i) {
    by_key[ops[i].key].push_back(i);
    order.push_back(ops[i].key);
  }
  for (std::size_t i = order.size(); i > 1; --i) {
    std::swap(order[i - 1], order[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
  }
  std::map<std::uint64_t, std::size_t> used;
  EngineOps<Scalar, Dim> result;
  for (const std::uint64_t key : order) result.push_back(ops[by_key[key][used[key]++]]);
  return result;
}

/// How the grids are set, and what steps go through them; scenes are in 0 to 100.
struct GridChoice {
  const char* name;
  int population = 0;    ///< 0: the engine's choice
  double cell_size = 0;  ///< 0: derived
  StepMethod method = StepMethod::kAuto;

  template <int Dim>
  [[nodiscard]] Config config(CellKind kind, std::shared_ptr<Executor> executor,
                              Reduction reduction = Reduction::kSingleReporter) const {
    Config config;
    config.cell.kind = kind;
    config.cell.segment_capacity = 4 + static_cast<int>(cell_size) % 5;  // small: cells hold few objects here
    if (population > 0) config.cell_population = population;
    if (cell_size > 0) config.cell_size = cell_size;
    // Without levels, wide boxes are in more cells of a fine grid than can be checked after every step.
    if (cell_size > 0 && reduction == Reduction::kWitnessCounts) {
      config.cell_size = std::max(cell_size, Dim == 2 ? 1.5 : Dim * 2.5);
    }
    config.reduction = reduction;
    config.step_method = method;
    config.executor = std::move(executor);
    config.parallel_from = 0;
    return config;
  }

  /// Without levels, boxes over a scene that reaches far out are in millions of cells, unless their size is derived.
  [[nodiscard]] bool suits(Place place, Reduction reduction) const {
    return place != Place::kFarOut || reduction == Reduction::kSingleReporter || cell_size == 0;
  }
};

inline constexpr std::array kGrids{
    GridChoice{.name = "derived", .method = StepMethod::kCells},
    GridChoice{.name = "one object per cell", .population = 1, .method = StepMethod::kCells},
    GridChoice{.name = "1000 objects per cell", .population = 1000, .method = StepMethod::kCells},
    GridChoice{.name = "swept", .method = StepMethod::kSweep},
    GridChoice{.name = "cells of 10", .cell_size = 10, .method = StepMethod::kCells},
    GridChoice{.name = "cells smaller than boxes", .cell_size = 1.5, .method = StepMethod::kCells},
    GridChoice{.name = "cells smaller than any box", .cell_size = 0.01, .method = StepMethod::kCells},
    GridChoice{.name = "as the engine chooses"},
    GridChoice{.name = "cells of 13", .cell_size = 13},
    GridChoice{.name = "huge cells", .cell_size = 1e9, .method = StepMethod::kCells},
};

inline constexpr std::array kKinds{CellKind::kRows, CellKind::kBatch, CellKind::kSegmented, CellKind::kClassic,
                                   CellKind::kPlane};
inline constexpr std::array<const char*, 5> kKindNames{"rows", "batch", "segmented", "classic", "plane"};
inline constexpr std::array kReductions{Reduction::kSingleReporter, Reduction::kWitnessCounts};
inline constexpr std::array<const char*, 2> kReductionNames{"single reporters", "witness counts"};
inline constexpr std::array kStepMethods{StepMethod::kAuto, StepMethod::kSweep, StepMethod::kCells};
inline constexpr std::array kThreadCounts{1, 2, 3, 8};

/// Settings, and what to call them.
struct NamedConfig {
  std::string name;
  Config config;
};

/// Every kind of cell, both reductions, on one thread.
inline std::vector<NamedConfig> all_configs() {
  std::vector<NamedConfig> all;
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
    for (std::size_t reduction = 0; reduction < kReductions.size(); ++reduction) {
      NamedConfig named{std::string(kKindNames[kind]) + ", " + kReductionNames[reduction], {}};
      named.config.cell.kind = kKinds[kind];
      named.config.reduction = kReductions[reduction];
      named.config.threads = 1;
      all.push_back(std::move(named));
    }
  }
  return all;
}

/// Plays a script to an engine and the model; says what differed and when, nothing when all was well.
template <class Scalar, int Dim, class Script>
std::string play(const Config& config, Script script, int steps, Calls calls) {
  Engine<Scalar, Dim> engine(config);
  EngineModel<Scalar, Dim> model;
  for (int step = 0; step < steps; ++step) {
    const EngineOps<Scalar, Dim> ops = script.next();
    std::string wrong;
    try {
      queue(engine, ops, calls);
      model.apply(ops);
      const Events<std::uint64_t>& events = engine.step();
      wrong = difference(model.step(), events);
      if (wrong.empty()) wrong = compare(engine, model);
    } catch (const std::exception& error) {
      wrong = std::string("exception: ") + error.what();
    }
    if (!wrong.empty()) return "step " + std::to_string(step) + ": " + wrong;
  }
  return {};
}

/// The scripts that cells are tested with, as queueing calls.
template <class Scalar, int Dim>
class CellScript {
 public:
  CellScript(const Regime& regime, std::uint64_t seed) : script_(regime, seed) {}
  EngineOps<Scalar, Dim> next() {
    EngineOps<Scalar, Dim> ops;
    for (const auto& op : script_.next()) ops.push_back({op.kind, op.object, op.box});
    return ops;
  }

 private:
  OpScript<Scalar, Dim> script_;
};

}  // namespace sweepgrid::oracle
