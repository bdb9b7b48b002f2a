// A small oracle test of steps that sweep the whole scene, and of scenes in which steps of both kinds take turns: `run`
// builds it anew for every planted bug. Exits with 1 and prints the name of each broken invariant when it notices
// something.

#include <cstdint>
#include <memory>
#include <string>

#include "play.hpp"

namespace sweepgrid {
namespace {

Config config_of(StepMethod method, bool many_workers) {
  Config config;
  config.step_method = method;
  if (many_workers) {
    config.executor = std::make_shared<Backwards>();
    config.parallel_from = 0;
  } else {
    config.threads = 1;
  }
  return config;
}

constexpr oracle::SceneRegime kSizes{
    .name = "Sizes", .place = oracle::Place::kSizes, .travel = oracle::Travel::kResize, .churn_percent = 5};
constexpr oracle::SceneRegime kTies{
    .name = "Ties", .place = oracle::Place::kLattice, .moving_percent = 30, .churn_percent = 5};
constexpr oracle::SceneRegime kGiants{
    .name = "Giants", .place = oracle::Place::kGiants, .moving_percent = 50, .churn_percent = 5, .pauses = true};
/// From end to end, over giants that rest: pairs that a jump does not part, others that are told of by both halves.
constexpr oracle::SceneRegime kJumps{.name = "Jumps",
                                     .place = oracle::Place::kGiants,
                                     .travel = oracle::Travel::kTeleport,
                                     .population = 200,
                                     .rebirth_percent = 5,
                                     .mayfly_percent = 5};
constexpr oracle::SceneRegime kFleeting{
    .name = "Fleeting", .population = 200, .moving_percent = 20, .churn_percent = 40};
/// Leaves the place where rows were fitted to it.
constexpr oracle::SceneRegime kDrift{
    .name = "Drift", .travel = oracle::Travel::kDrift, .population = 200, .moving_percent = 90};
/// In many rows, and in granules that blocks cannot share out evenly.
constexpr oracle::SceneRegime kMany{.name = "Many", .population = 1700, .churn_percent = 2, .steps = 4};
constexpr oracle::SceneRegime kTurns{
    .name = "Turns", .place = oracle::Place::kSizes, .population = 200, .moving_percent = 100, .churn_percent = 2};

/// More overlaps in one row than a sweep keeps back before it tells of them.
int probe_crowd(const Config& config) {
  int number = 0;
  return probe(
      config, "Crowd",
      [&] {
        constexpr std::uint64_t kCrowd = 250;
        Ops ops;
        const bool together = number % 2 == 0;
        for (std::uint64_t key = 0; key < kCrowd; ++key) {
          const float place = together ? 0 : 10 * static_cast<float>(key);
          ops.push_back(
              {number == 0 ? OpKind::kInsert : OpKind::kUpdate, key, Box<float, 2>({place, 0}, {place + 1, 1})});
        }
        ++number;
        return ops;
      },
      3);
}

/// Many small boxes, and some that are in more than two rows and in many bins.
int probe_many(const Config& config) {
  oracle::SceneScript<float, 2> small(kMany, 1);
  oracle::Random random(1);
  int number = 0;
  const auto next = [&] {
    Ops ops = small.next();
    for (std::uint64_t i = 0; i < 6; ++i) {
      const auto x = static_cast<float>(random.below(70));
      const auto y = static_cast<float>(random.below(70));
      const bool lies = i % 2 == 0;
      ops.push_back({number == 0 ? OpKind::kInsert : OpKind::kUpdate, 200'000 + i,
                     Box<float, 2>({x, y}, {x + (lies ? 30 : 1), y + (lies ? 1 : 30)})});
    }
    ++number;
    return ops;
  };
  return probe(config, kMany.name, next, kMany.steps);
}

/// A scene in which everybody moves in the first of every so many steps, and few do in the others: cells come and go.
class Turns {
 public:
  static constexpr int kSteps = 32;

  Ops next() {
    Ops ops = script_.next();
    if (number_++ % 8 == 0) return ops;
    Ops few;
    for (const auto& op : ops) {
      if (op.kind != OpKind::kUpdate || random_.percent(3)) few.push_back(op);
    }
    return few;
  }

 private:
  oracle::SceneScript<float, 2> script_{kTurns, 1};
  oracle::Random random_{1};
  int number_ = 0;
};

int probe_turns(const Config& config) {
  Turns scene;
  Turns refused_scene;
  std::uint64_t steps = 0;
  std::uint64_t sweeps = 0;
  std::uint64_t changes = 0;  // of the way
  const auto note = [&](const TestEngine& engine) {
    const std::uint64_t sweep = engine.stats().step.sweeps;
    changes += steps > 0 && (sweep != 0) != (sweeps != 0) ? 1 : 0;
    sweeps = sweep;
    ++steps;
  };
  const int status = probe(
      config, kTurns.name, [&] { return scene.next(); }, Turns::kSteps, note);
  if (status != 0) return status;
  if (changes < 4) return report(kTurns.name, Turns::kSteps, {"follow: steps do not take turns"});
  return probe_refusals(
      config, kTurns.name, [&] { return refused_scene.next(); }, Turns::kSteps);
}

int probe_all() {
  for (const bool many_workers : {false, true}) {
    const Config swept = config_of(StepMethod::kSweep, many_workers);
    for (const auto& regime : {kSizes, kTies, kGiants, kJumps, kFleeting, kDrift}) {
      if (probe_scene(swept, regime) != 0) return 1;
    }
    if (probe_refusals(swept, kFleeting) != 0 || probe_refusals(swept, kJumps) != 0) return 1;
    if (probe_crowd(swept) != 0 || probe_turns(config_of(StepMethod::kAuto, many_workers)) != 0) return 1;
  }
  return probe_many(config_of(StepMethod::kSweep, true));
}

}  // namespace
}  // namespace sweepgrid

int main() { return sweepgrid::probe_all(); }
