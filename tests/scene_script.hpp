#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "engine_model.hpp"
#include "op_script.hpp"

/// Random scenes, step by step: who is where, who moves how, who comes and goes.
namespace sweepgrid::oracle {

/// Where objects are at first, and when they come in later. Space is 0 to 100 on every axis.
enum class Place {
  kUniform,
  kLattice,     ///< integer coordinates, few of them, both zeros: nearly everything ties
  kThin,        ///< no thickness on some axes
  kOnePoint,    ///< all in one small cell
  kHotAndCold,  ///< four of five in a hundredth of space
  kGiants,      ///< some over all cells, some infinite on one side or on both: ground planes
  kFarOut,      ///< some at 1e6, some at 1e30
  kSizes,       ///< widths over four decades, small ones being the more
};

enum class Travel {
  kStay,
  kJitter,
  kTeleport,
  kFast,      ///< several times its own width
  kDrift,     ///< the whole scene leaves its bounds
  kCollapse,  ///< the whole scene shrinks to a point
  kResize,    ///< moves a little and becomes up to ten times as wide or narrow: from level to level
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
  bool alternates = false;      ///< all move in every other step, few in the others
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
    const int moving = !regime_.alternates ? regime_.moving_percent : step_ % 2 == 0 ? 100 : 4;
    if (!random_.percent(moving)) return;
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
    if (regime_.place == Place::kSizes) {
      const double half = kSpace * std::pow(10, -4 * std::sqrt(real(0, 1)));
      for (double& own : body.half) own = half * real(0.5, 1);
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
    const double growth = travel == Travel::kResize ? std::pow(10, real(-1, 1)) : 1;
    for (int axis = 0; axis < Dim; ++axis) {
      double& centre = body.centre[axis];
      if (travel == Travel::kResize) body.half[axis] = std::min(body.half[axis] * growth, 10 * kSpace);
      const double half = std::min(body.half[axis], kSpace);
      if (regime_.place == Place::kLattice && travel == Travel::kJitter)
        centre += random_.between(-1, 1) * 2;
      else if (travel == Travel::kJitter || travel == Travel::kResize)
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
    SceneRegime{.name = "Sizes", .place = Place::kSizes, .churn_percent = 5, .rebirth_percent = 5},
    SceneRegime{.name = "SizesFewMove", .place = Place::kSizes, .moving_percent = 5, .churn_percent = 2, .steps = 20},
    SceneRegime{.name = "Resize", .place = Place::kSizes, .travel = Travel::kResize, .churn_percent = 5, .steps = 16},
    SceneRegime{.name = "ResizeFew", .travel = Travel::kResize, .moving_percent = 10, .steps = 24},
    SceneRegime{.name = "DenseAndSparse", .churn_percent = 3, .rebirth_percent = 3, .alternates = true, .steps = 16},
    SceneRegime{.name = "SizesDenseAndSparse", .place = Place::kSizes, .churn_percent = 3, .alternates = true},
    SceneRegime{.name = "GiantsDenseAndSparse", .place = Place::kGiants, .alternates = true, .steps = 10},
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

}  // namespace sweepgrid::oracle
