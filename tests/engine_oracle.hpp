#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <exception>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <sweepgrid/engine/engine.hpp>

#include "op_script.hpp"

/// The brute-force oracle of engines, random scenes to put both through, and the ways to queue one and the same step.
/// Needs no test framework, so that small programs can use it too.
namespace sweepgrid::oracle {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SWEEPGRID_ORACLE_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SWEEPGRID_ORACLE_SANITIZED 1
#endif
#endif
#ifdef SWEEPGRID_ORACLE_SANITIZED
/// Sanitizers make everything about ten times as slow, so the matrices are thinned out there.
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// One queueing call.
template <class Scalar, int Dim>
struct EngineOp {
  OpKind kind = OpKind::kInsert;
  std::uint64_t key = 0;
  Box<Scalar, Dim> box{};
};

template <class Scalar, int Dim>
using EngineOps = std::vector<EngineOp<Scalar, Dim>>;

/// What an engine should say: compares every box with every other.
template <class Scalar, int Dim, class Key = std::uint64_t, class Order = std::less<Key>>
class EngineModel {
 public:
  using BoxType = Box<Scalar, Dim>;

  void insert(const Key& key, const BoxType& box) {
    boxes_.insert_or_assign(key, box);
    fresh_.insert(key);
  }
  void update(const Key& key, const BoxType& box) { boxes_.at(key) = box; }
  void erase(const Key& key) { boxes_.erase(key); }
  void apply(const EngineOps<Scalar, Dim>& ops) {
    for (const auto& op : ops) {
      if (op.kind == OpKind::kInsert) insert(op.key, op.box);
      if (op.kind == OpKind::kUpdate) update(op.key, op.box);
      if (op.kind == OpKind::kErase) erase(op.key);
    }
  }

  /// The events of everything since the last call.
  const Events<Key>& step() {
    std::vector<Key> keys;  // sorted, for the map is; and so the pairs come out sorted
    std::vector<BoxType> boxes;
    for (const auto& [key, box] : boxes_) keys.push_back(key), boxes.push_back(box);
    std::vector<Pair<Key>> now;
    for (std::size_t a = 0; a < boxes.size(); ++a) {
      for (std::size_t b = a + 1; b < boxes.size(); ++b) {
        if (boxes[a].overlaps(boxes[b])) now.push_back({keys[a], keys[b]});
      }
    }
    // A key that was inserted anew names another object than before: its old pairs end and its new ones begin.
    const auto fresh = [this](const Pair<Key>& pair) {
      return fresh_.count(pair.first) + fresh_.count(pair.second) > 0;
    };
    const auto missing = [&](const std::vector<Pair<Key>>& list, const std::vector<Pair<Key>>& other) {
      std::vector<Pair<Key>> result;
      for (const auto& pair : list) {
        if (fresh(pair) || !std::binary_search(other.begin(), other.end(), pair, less)) result.push_back(pair);
      }
      return result;
    };
    events_.ends = missing(pairs_, now);
    events_.begins = missing(now, pairs_);
    pairs_ = std::move(now);
    fresh_.clear();
    return events_;
  }

  [[nodiscard]] const std::vector<Pair<Key>>& pairs() const { return pairs_; }
  [[nodiscard]] const std::map<Key, BoxType, Order>& boxes() const { return boxes_; }

  static bool less(const Pair<Key>& a, const Pair<Key>& b) {
    const Order order;
    return order(a.first, b.first) || (!order(b.first, a.first) && order(a.second, b.second));
  }

 private:
  std::map<Key, BoxType, Order> boxes_;
  std::set<Key, Order> fresh_;  // inserted since the last step
  std::vector<Pair<Key>> pairs_;
  Events<Key> events_;
};

/// The first difference of two lists of pairs in words; nothing when they are the same, order and duplicates included.
template <class Key>
std::string difference(const char* what, const std::vector<Pair<Key>>& expected, const std::vector<Pair<Key>>& actual) {
  if (expected == actual) return {};
  std::ostringstream text;
  text << actual.size() << " " << what << " instead of " << expected.size();
  const auto [want, got] = std::mismatch(expected.begin(), expected.end(), actual.begin(), actual.end());
  const auto say = [&](const char* label, const auto& list, auto at) {
    text << "; " << label << " at " << at - list.begin() << ": ";
    if (at == list.end()) {
      text << "nothing";
    } else if constexpr (requires { text << at->first; }) {
      text << "(" << at->first << ", " << at->second << ")";
    }
  };
  say("expected", expected, want);
  say("found", actual, got);
  return text.str();
}

template <class Key>
std::string difference(const Events<Key>& expected, const Events<Key>& actual) {
  std::string wrong = difference("ends", expected.ends, actual.ends);
  return wrong.empty() ? difference("begins", expected.begins, actual.begins) : wrong;
}

/// Compares all that can be asked of the engine after a step with the model, and validates it.
template <class EngineType, class Model>
std::string compare(const EngineType& engine, const Model& model) {
  std::string wrong = difference("pairs", model.pairs(), engine.pairs());
  if (!wrong.empty()) return wrong;
  if (engine.size() != model.boxes().size()) return "size() is " + std::to_string(engine.size());
  for (const auto& [key, box] : model.boxes()) {
    const auto handle = engine.find(key);
    if (!handle) return "a key is unknown";
    if (!engine.contains(key) || !(engine.key(*handle) == key) || engine.box(*handle) != box) {
      return "contains(), key() or box() of an object is wrong";
    }
  }
  try {
    engine.validate();
  } catch (const std::exception& error) {
    return std::string("validate(): ") + error.what();
  }
  return {};
}

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

/// Where objects are at first, and when they come in later. Space is 0 to 100 on every axis.
enum class Place {
  kUniform,
  kLattice,     ///< integer coordinates, few of them, both zeros: nearly everything ties
  kThin,        ///< no thickness on some axes
  kOnePoint,    ///< all in one small cell
  kHotAndCold,  ///< four of five in a hundredth of space
  kGiants,      ///< some over all cells, some infinite on one side or on both: ground planes
  kFarOut,      ///< some at 1e6, some at 1e30
};

enum class Travel {
  kStay,
  kJitter,
  kTeleport,
  kFast,      ///< several times its own width
  kDrift,     ///< the whole scene leaves its bounds
  kCollapse,  ///< the whole scene shrinks to a point
  kAny,       ///< any of the first four
};

/// How a scene behaves.
struct SceneRegime {
  const char* name;
  Place place = Place::kUniform;
  Travel travel = Travel::kAny;
  int population = 120;
  int last_population = -1;  ///< where it grows or shrinks to; -1: stays
  int moving_percent = 60;
  int churn_percent = 0;
  int rebirth_percent = 0;  ///< erased and inserted again in one step
  int mayfly_percent = 0;   ///< of as many objects again, inserted and erased in one step
  int two_updates_percent = 0;
  bool all_or_nothing = false;  ///< every other step erases everything
  bool pauses = false;          ///< every third step is empty
  int steps = 12;
};

/// Writes the ops of a scene step by step; the same for the same regime and seed.
template <class Scalar, int Dim>
class SceneScript {
 public:
  using Op = EngineOp<Scalar, Dim>;

  SceneScript(const SceneRegime& regime, std::uint64_t seed) : regime_(regime), random_(seed) {
    // About three overlaps per box, whatever the population.
    const int most = std::max({4, regime.population, regime.last_population});
    half_ = kSpace * std::pow(3.0 / most, 1.0 / Dim) / 4;
  }

  EngineOps<Scalar, Dim> next() {
    EngineOps<Scalar, Dim> ops;
    const int step = step_++;
    if (regime_.pauses && step % 3 == 2) return ops;
    const int wanted = regime_.all_or_nothing && step % 2 == 1 ? 0 : population_at(step);
    std::vector<Body> bodies;
    bodies.swap(bodies_);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const auto left = static_cast<int>(bodies_.size() + bodies.size() - i);
      if (random_.percent(regime_.churn_percent) || left > wanted) {
        ops.push_back({OpKind::kErase, bodies[i].key, {}});
        free_keys_.push_back(bodies[i].key);
      } else {
        act(bodies[i], ops);
        bodies_.push_back(bodies[i]);
      }
    }
    while (static_cast<int>(bodies_.size()) < wanted) {
      Body body = anywhere();
      body.key = new_key();
      ops.push_back({OpKind::kInsert, body.key, box(body)});
      bodies_.push_back(body);
    }
    add_mayflies(ops);
    return ops;
  }

  [[nodiscard]] int steps() const { return regime_.steps; }

 private:
  static constexpr double kSpace = 100;

  struct Body {
    std::uint64_t key = 0;
    std::array<double, Dim> centre;
    std::array<double, Dim> half;
  };

  [[nodiscard]] int population_at(int step) const {
    if (regime_.last_population < 0) return regime_.population;
    const double share = static_cast<double>(step) / std::max(1, regime_.steps - 1);
    const double ratio = std::max(1, regime_.last_population) / std::max(1.0, 1.0 * regime_.population);
    return step + 1 >= regime_.steps ? regime_.last_population
                                     : static_cast<int>(std::lround(regime_.population * std::pow(ratio, share)));
  }

  // Keys come in no order, and those of erased objects come back, those of this step too.
  std::uint64_t new_key() {
    if (!free_keys_.empty() && random_.percent(50)) {
      const auto at = static_cast<std::size_t>(random_.below(static_cast<int>(free_keys_.size())));
      std::swap(free_keys_[at], free_keys_.back());
      const std::uint64_t key = free_keys_.back();
      free_keys_.pop_back();
      return key;
    }
    ++serial_;
    return serial_ * 7919 % 100'003 + (serial_ % 2 << 63);
  }

  void act(Body& body, EngineOps<Scalar, Dim>& ops) {
    if (random_.percent(regime_.rebirth_percent)) {
      if (random_.percent(30)) ops.push_back({OpKind::kUpdate, body.key, box(anywhere())});
      ops.push_back({OpKind::kErase, body.key, {}});
      if (random_.percent(20)) {
        ops.push_back({OpKind::kInsert, body.key, box(anywhere())});
        ops.push_back({OpKind::kErase, body.key, {}});
      }
      if (random_.percent(50)) move(body);
      const bool twice = random_.percent(30);
      ops.push_back({OpKind::kInsert, body.key, box(twice ? anywhere() : body)});
      if (twice) ops.push_back({OpKind::kUpdate, body.key, box(body)});
      return;
    }
    if (!random_.percent(regime_.moving_percent)) return;
    if (random_.percent(regime_.two_updates_percent)) ops.push_back({OpKind::kUpdate, body.key, box(anywhere())});
    // Sometimes the last of two updates leads back to where the object was.
    if (!random_.percent(regime_.two_updates_percent / 3)) move(body);
    ops.push_back({OpKind::kUpdate, body.key, box(body)});
  }

  void add_mayflies(EngineOps<Scalar, Dim>& ops) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (!random_.percent(regime_.mayfly_percent)) continue;
      const std::uint64_t key = new_key();
      ops.push_back({OpKind::kInsert, key, box(anywhere())});
      if (random_.percent(30)) ops.push_back({OpKind::kUpdate, key, box(anywhere())});
      ops.push_back({OpKind::kErase, key, {}});
      free_keys_.push_back(key);
    }
  }

  double real(double low, double high) { return low + (high - low) * random_.below(1 << 20) / (1 << 20); }

  Body anywhere() {
    Body body;
    const bool hot = regime_.place == Place::kHotAndCold && random_.percent(80);
    for (int axis = 0; axis < Dim; ++axis) {
      body.centre[axis] = hot ? real(20, 20 + kSpace * std::pow(0.01, 1.0 / Dim)) : real(0, kSpace);
      body.half[axis] = real(0, half_) * (hot ? 0.3 : 1);
      if (regime_.place == Place::kThin && random_.percent(60)) body.half[axis] = 0;
      if (regime_.place == Place::kLattice) {
        body.centre[axis] = random_.between(-5, 5) * 4;
        body.half[axis] = random_.below(2) * 2;
      }
      if (regime_.place == Place::kOnePoint) {
        body.centre[axis] = 50 + real(0, 0.01);
        body.half[axis] = real(0, 0.001);
      }
    }
    const auto some_axis = static_cast<std::size_t>(random_.below(Dim));
    if (regime_.place == Place::kGiants && random_.percent(6)) {
      const int what = random_.below(3);
      if (what == 0) body.half.fill(80);
      if (what == 1) body.half.fill(std::numeric_limits<double>::infinity());
      if (what >= 1) body.half[some_axis] = what == 1 ? 1 : std::numeric_limits<double>::infinity();
    }
    if (regime_.place == Place::kFarOut && random_.percent(6)) {
      body.centre[some_axis] = (random_.percent(50) ? 1e6 : 1e30) * (random_.percent(50) ? 1 : -1);
      if (random_.percent(50)) body.half[some_axis] = std::abs(body.centre[some_axis]) * real(0, 2);
    }
    return body;
  }

  void move(Body& body) {
    Travel travel = regime_.travel;
    if (travel == Travel::kAny) travel = static_cast<Travel>(random_.below(4));
    if (travel == Travel::kStay) return;
    if (travel == Travel::kTeleport || (regime_.place == Place::kLattice && travel == Travel::kFast)) {
      const std::uint64_t key = body.key;
      body = anywhere();
      body.key = key;
      return;
    }
    for (int axis = 0; axis < Dim; ++axis) {
      double& centre = body.centre[axis];
      const double half = std::min(body.half[axis], kSpace);
      if (regime_.place == Place::kLattice && travel == Travel::kJitter)
        centre += random_.between(-1, 1) * 2;
      else if (travel == Travel::kJitter)
        centre += real(-half_, half_) / 4;
      else if (travel == Travel::kFast)
        centre += half * random_.between(-8, 8);
      else if (travel == Travel::kDrift)
        centre += 17 + axis;
      else if (travel == Travel::kCollapse)
        centre = 50 + (centre - 50) / 4;
    }
  }

  static Scalar scalar(double value) {
    if constexpr (std::floating_point<Scalar>) {
      return static_cast<Scalar>(value);
    } else {
      using Limits = std::numeric_limits<Scalar>;
      if (value >= static_cast<double>(Limits::max())) return Limits::max();
      if (value <= static_cast<double>(Limits::min())) return Limits::min();
      return static_cast<Scalar>(std::floor(value));
    }
  }

  Box<Scalar, Dim> box(const Body& body) {
    Box<Scalar, Dim> box;
    for (int axis = 0; axis < Dim; ++axis) {
      box.min[axis] = scalar(body.centre[axis] - body.half[axis]);
      box.max[axis] = scalar(body.centre[axis] + body.half[axis]);
      if constexpr (std::floating_point<Scalar>) {
        if (box.min[axis] == 0 && random_.percent(50)) box.min[axis] = Scalar(-0.0);
        if (box.max[axis] == 0 && random_.percent(50)) box.max[axis] = Scalar(-0.0);
      }
    }
    return box;
  }

  SceneRegime regime_;
  Random random_;
  double half_ = 1;
  int step_ = 0;
  std::vector<Body> bodies_;
  std::vector<std::uint64_t> free_keys_;
  std::uint64_t serial_ = 0;
};

/// One regime for each thing that could break the way from boxes to events.
inline constexpr std::array kSceneRegimes{
    SceneRegime{.name = "Uniform", .churn_percent = 5},
    SceneRegime{.name = "EverythingAtOnce",
                .churn_percent = 10,
                .rebirth_percent = 10,
                .mayfly_percent = 10,
                .two_updates_percent = 30},
    SceneRegime{.name = "Lattice", .place = Place::kLattice, .churn_percent = 5, .rebirth_percent = 5},
    SceneRegime{.name = "LatticeFewMove", .place = Place::kLattice, .moving_percent = 4, .steps = 24},
    SceneRegime{.name = "Thin", .place = Place::kThin, .churn_percent = 5},
    SceneRegime{.name = "OnePoint", .place = Place::kOnePoint, .population = 60, .churn_percent = 5},
    SceneRegime{.name = "HotAndCold", .place = Place::kHotAndCold, .churn_percent = 5},
    SceneRegime{.name = "Giants", .place = Place::kGiants, .churn_percent = 10, .rebirth_percent = 5},
    SceneRegime{.name = "GiantsFewMove", .place = Place::kGiants, .moving_percent = 5, .churn_percent = 1, .steps = 20},
    SceneRegime{.name = "FarOut", .place = Place::kFarOut, .churn_percent = 5},
    SceneRegime{.name = "Teleport", .travel = Travel::kTeleport, .moving_percent = 100},
    SceneRegime{.name = "TeleportFew", .travel = Travel::kTeleport, .moving_percent = 5, .steps = 20},
    SceneRegime{.name = "FastMovers", .travel = Travel::kFast},
    SceneRegime{.name = "Drift", .travel = Travel::kDrift, .moving_percent = 100, .churn_percent = 3, .steps = 20},
    SceneRegime{.name = "Collapse", .travel = Travel::kCollapse, .moving_percent = 100, .steps = 8},
    SceneRegime{.name = "ChurnHalf", .churn_percent = 50, .pauses = true},
    SceneRegime{.name = "ChurnAll", .moving_percent = 0, .churn_percent = 100},
    SceneRegime{.name = "RebirthAll", .place = Place::kLattice, .population = 60, .rebirth_percent = 100},
    SceneRegime{.name = "Mayflies", .population = 40, .mayfly_percent = 100, .pauses = true},
    SceneRegime{.name = "LastUpdateWins", .moving_percent = 100, .two_updates_percent = 100},
    SceneRegime{.name = "AllOrNothing", .all_or_nothing = true, .steps = 8},
    SceneRegime{.name = "Grow", .population = 3, .last_population = 500, .moving_percent = 20, .churn_percent = 3},
    SceneRegime{.name = "Shrink", .population = 500, .last_population = 0, .moving_percent = 20, .churn_percent = 3},
    SceneRegime{.name = "Nobody", .population = 0, .steps = 3},
    SceneRegime{.name = "Alone", .population = 1, .churn_percent = 20, .rebirth_percent = 20},
};

/// How the grid is set; scenes are in 0 to 100.
struct GridChoice {
  const char* name;
  int population = 48;
  double cell_size = 0;  ///< 0: derived
  double lower = 0;
  double upper = -1;  ///< below `lower`: bounds are derived

  template <class Scalar, int Dim>
  [[nodiscard]] Config<Scalar, Dim> config(CellKind kind, std::shared_ptr<Executor> executor) const {
    Config<Scalar, Dim> config;
    config.cell.kind = kind;
    config.cell.segment_capacity = 4 + static_cast<int>(lower + cell_size) % 5;  // small: cells hold few objects here
    config.cell_population = population;
    // In three dimensions and more a fine grid has too many cells to be checked after every step.
    if (cell_size > 0) config.cell_size = Dim == 2 ? cell_size : std::max(cell_size, Dim * 2.5);
    if (upper >= lower) {
      config.bounds.emplace();
      config.bounds->min.fill(static_cast<Scalar>(lower));
      config.bounds->max.fill(static_cast<Scalar>(upper));
    }
    config.executor = std::move(executor);
    return config;
  }

  /// Whether the bounds keep the number of cells down when an object is far away.
  [[nodiscard]] bool bounded() const { return cell_size == 0 || upper >= lower; }
};

inline constexpr std::array kGrids{
    GridChoice{.name = "derived"},
    GridChoice{.name = "one object per cell", .population = 1},
    GridChoice{.name = "1000 objects per cell", .population = 1000},
    GridChoice{.name = "fixed", .cell_size = 10, .upper = 100},
    GridChoice{.name = "cells smaller than boxes", .cell_size = 1.5, .upper = 100},
    GridChoice{.name = "bounds given", .population = 5, .upper = 100},
    GridChoice{.name = "cell size given", .cell_size = 13},
    GridChoice{.name = "huge cells", .cell_size = 1e9},
    GridChoice{.name = "bounds miss most objects", .cell_size = 3, .lower = 40, .upper = 60},
    GridChoice{.name = "bounds are a point", .population = 5, .lower = 50, .upper = 50},
};

inline constexpr std::array kKinds{CellKind::kBatch, CellKind::kSegmented, CellKind::kClassic, CellKind::kPlane};
inline constexpr std::array<const char*, 4> kKindNames{"batch", "segmented", "classic", "plane"};
inline constexpr std::array kThreadCounts{1, 2, 3, 8};

/// Plays a script to an engine and the model; says what differed and when, nothing when all was well.
template <class Scalar, int Dim, class Script>
std::string play(const Config<Scalar, Dim>& config, Script script, int steps, Calls calls) {
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
