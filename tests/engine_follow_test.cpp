// Grids follow their scene, and nobody outside notices: events are those of brute force while objects move from grid to
// grid, whatever else happens in the same steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "engine_oracle.hpp"

namespace sweepgrid::oracle::engine_follow_test {
namespace {

using Engine2 = Engine<float, 2>;
using Box2 = Box<float, 2>;
using Ops = EngineOps<float, 2>;

enum class Moving { kFew, kAll, kByTurns };

struct FollowCase {
  const char* name;
  Moving moving = Moving::kFew;
  bool sizes = false;     ///< widths over four decades and some without end, else all alike
  bool churn = false;     ///< erases, inserts, rebirths and teleports all the time
  bool vanishes = false;  ///< to nothing, or nearly so, and back
};

/// A scene that grows eightfold within a step, goes on for a while, and shrinks as fast, or vanishes and grows again.
class FollowScript {
 public:
  static constexpr int kSteps = 40;

  FollowScript(const FollowCase& scene, std::uint64_t seed) : scene_(scene), random_(seed) {}

  Ops next() {
    Ops ops;
    const int step = step_++;
    if (step == 0) insert(ops, kFew);
    if (step == 3) insert(ops, kMany - kFew);
    if (step == 16) erase(ops, scene_.vanishes ? static_cast<int>(keys_.size()) : kMany * 7 / 8);
    if (step == 19) insert(ops, scene_.vanishes ? kMany : 0);
    if (scene_.churn) {
      erase(ops, static_cast<int>(keys_.size()) / 20);
      insert(ops, static_cast<int>(keys_.size()) / 20);
    }
    const bool all = scene_.moving == Moving::kAll || (scene_.moving == Moving::kByTurns && step % 2 == 0);
    for (std::size_t i = 0; i < old_; ++i) {
      const std::uint64_t key = keys_[i];
      if (!all && !random_.percent(3)) continue;
      if (scene_.churn && random_.percent(3)) {
        ops.push_back({OpKind::kErase, key, {}});
        ops.push_back({OpKind::kInsert, key, any_box()});
      } else {
        ops.push_back({OpKind::kUpdate, key, any_box()});
      }
    }
    old_ = keys_.size();
    return ops;
  }

 private:
  static constexpr int kFew = 180;
  static constexpr int kMany = 1400;

  Box2 any_box() {
    const auto place = [&] { return static_cast<float>(random_.below(100'000)) / 1000; };
    float width = 0.6F;
    if (scene_.sizes) width = static_cast<float>(std::pow(10, -2 + 4 * std::pow(random_.below(1000) / 1000.0, 6)));
    const float x = place();
    const float y = place();
    Box2 box({x, y}, {x + width, y + width / 2});
    if (scene_.sizes && random_.below(200) == 0) box.max[0] = std::numeric_limits<float>::infinity();
    return box;
  }

  void insert(Ops& ops, int count) {
    for (int i = 0; i < count; ++i) {
      ops.push_back({OpKind::kInsert, ++serial_, any_box()});
      keys_.push_back(serial_);
    }
  }

  void erase(Ops& ops, int count) {
    for (int i = 0; i < count && old_ > 0; ++i) {
      const auto at = static_cast<std::size_t>(random_.below(static_cast<int>(old_)));
      ops.push_back({OpKind::kErase, keys_[at], {}});
      keys_[at] = keys_[--old_];
      keys_[old_] = keys_.back();
      keys_.pop_back();
    }
  }

  FollowCase scene_;
  Random random_;
  int step_ = 0;
  std::vector<std::uint64_t> keys_;
  std::size_t old_ = 0;  // keys [0, old_) are those of the step before
  std::uint64_t serial_ = 0;
};

struct Journey {
  std::string wrong;
  std::vector<StepCounters> counters;
  std::uint64_t regrids = 0;
  std::size_t most_grids = 0;  // after a refit
  std::size_t last_grids = 0;
};

/// What is queued in a step, and what is true after it.
struct KnownStep {
  Ops ops;
  EngineModel<float, 2> model;
};

/// Once for all settings: brute force takes longer than any of them.
std::vector<KnownStep> known_steps(const FollowCase& scene) {
  FollowScript script(scene, 3);
  EngineModel<float, 2> model;
  std::vector<KnownStep> steps;
  for (int step = 0; step < FollowScript::kSteps; ++step) {
    Ops ops = script.next();
    model.apply(ops);
    model.step();
    steps.push_back({std::move(ops), model});
  }
  return steps;
}

Journey travel(const std::vector<KnownStep>& steps, const Config& config, Calls calls) {
  Engine2 engine(config);
  Journey journey;
  for (std::size_t step = 0; step < steps.size() && journey.wrong.empty(); ++step) {
    const auto& [ops, model] = steps[step];
    try {
      queue(engine, ops, calls);
      journey.wrong = difference(model.events(), engine.step());
      if (journey.wrong.empty()) journey.wrong = compare(engine, model);
    } catch (const std::exception& error) {
      journey.wrong = std::string("exception: ") + error.what();
    }
    if (!journey.wrong.empty()) journey.wrong += " in step " + std::to_string(step);
    const Stats stats = engine.stats();
    journey.counters.push_back(stats.step);
    journey.regrids = stats.total.regrids;
    journey.last_grids = stats.grids;
    if (step > 0) journey.most_grids = std::max(journey.most_grids, stats.grids);
  }
  return journey;
}

class EngineFollows : public ::testing::TestWithParam<FollowCase> {
 protected:
  static Config config(CellKind kind, Reduction reduction, int threads, StepMethod method) {
    Config config;
    config.step_method = method;
    config.cell.kind = kind;
    config.cell.segment_capacity = 8;
    config.cell_population = 10;
    config.reduction = reduction;
    config.threads = threads;
    config.parallel_from = 0;
    return config;
  }
};

TEST_P(EngineFollows, EventsAreThoseOfBruteForceWhileObjectsAreOnTheirWay) {
  const std::vector<KnownStep> steps = known_steps(GetParam());
  std::size_t turn = 0;
  for (const CellKind kind : {CellKind::kRows, CellKind::kBatch, CellKind::kSegmented}) {
    for (const Reduction reduction : kReductions) {
      for (const StepMethod method : kStepMethods) {
        if (method != StepMethod::kCells && kind != CellKind::kRows) continue;
        // Under a sanitizer two settings for each scene, by turns.
        if (++turn; kSanitized && !plays_all() && (turn + first_turn(GetParam().name)) % 5 != 0) continue;
        const Calls calls = kCalls[turn % 3];  // inserts in order, so that ids are the same for any number of threads
        const Journey one = travel(steps, config(kind, reduction, 1, method), calls);
        const Journey four = travel(steps, config(kind, reduction, 4, method), calls);
        ASSERT_EQ(one.wrong, "") << "kind " << static_cast<int>(kind) << ", " << static_cast<int>(reduction);
        ASSERT_EQ(four.wrong, "") << "kind " << static_cast<int>(kind) << ", " << static_cast<int>(reduction);
        EXPECT_EQ(one.counters, four.counters);
        if (method == StepMethod::kCells) {
          EXPECT_GE(one.regrids, 2u) << "the scene was to outgrow its cells";
        }
        if (reduction == Reduction::kWitnessCounts) {
          EXPECT_EQ(one.most_grids, 1u);
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, EngineFollows,
                         ::testing::Values(FollowCase{"FewMove"}, FollowCase{"AllMove", Moving::kAll},
                                           FollowCase{"ByTurns", Moving::kByTurns},
                                           FollowCase{"FewMoveAmongManySizes", Moving::kFew, true},
                                           FollowCase{"AllMoveAmongManySizes", Moving::kAll, true, true},
                                           FollowCase{"ComingAndGoing", Moving::kFew, false, true},
                                           FollowCase{"ComingAndGoingInManySizes", Moving::kByTurns, true, true},
                                           FollowCase{"Vanishing", Moving::kFew, true, false, true},
                                           FollowCase{"VanishingAmidChurn", Moving::kAll, false, true, true}),
                         [](const auto& scene) { return std::string(scene.param.name); });

// New cells are for all, also for those who never move again.
TEST(EngineFollowsTheFew, WhoRestsGetsNewCellsLikeTheOthers) {
  for (const CellKind kind : {CellKind::kRows, CellKind::kBatch}) {
    Config config;
    config.cell.kind = kind;
    config.threads = 1;
    config.step_method = StepMethod::kCells;
    Engine2 engine(config);
    EngineModel<float, 2> model;
    Random random(1);
    const auto put = [&](std::uint64_t key, float width) {
      const float x = static_cast<float>(random.below(10'000)) / 100;
      const float y = static_cast<float>(random.below(10'000)) / 100;
      const Box2 box({x, y}, {x + width, y + width});
      engine.contains(key) ? engine.update(key, box) : static_cast<void>(engine.insert(key, box));
      model.insert(key, box);
    };
    for (std::uint64_t key = 0; key < 900; ++key) put(key, 0.5F);
    for (std::uint64_t key = 900; key < 920; ++key) put(key, 30);
    engine.step();
    model.step();
    for (std::uint64_t key = 920; key < 3000; ++key) put(key, 0.2F);
    engine.step();
    model.step();
    EXPECT_EQ(engine.stats().total.regrids, 2u);
    EXPECT_EQ(engine.stats().grids, 2u);
    for (int step = 0; step < 20; ++step) {
      Ops ops;
      for (int i = 0; i < 10; ++i) {
        const auto key = static_cast<std::uint64_t>(random.below(800));
        const float x = static_cast<float>(random.below(10'000)) / 100;
        ops.push_back({OpKind::kUpdate, key, Box2({x, x}, {x + 0.5F, x + 0.5F})});
      }
      queue(engine, ops, Calls::kByKey);
      model.apply(ops);
      ASSERT_EQ(difference(model.step(), engine.step()), "") << "step " << step;
      ASSERT_EQ(compare(engine, model), "") << "step " << step;
    }
    EXPECT_EQ(engine.stats().grids, 2u);
  }
}

}  // namespace
}  // namespace sweepgrid::oracle::engine_follow_test
