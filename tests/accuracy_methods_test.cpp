// The methods of the stability map: what they claim holds where nothing is hard, the engine's claim holds everywhere.

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "accuracy/method_trial.hpp"
#include "accuracy/methods.hpp"
#include "accuracy/narrow_phase.hpp"
#include "accuracy/regimes.hpp"
#include "measure/stopwatch.hpp"
#include "sanitized.hpp"

namespace sweepgrid::accuracy::accuracy_methods_test {
namespace {

constexpr RunBudget kBudget{std::uint64_t{1} << 30, 120};

// The sanitizer's allocator takes more address space than any budget, and a process of its own is not its place.
constexpr const char* kNoGuardedRuns = "guarded runs are not for sanitizers";
bool guarded_runs_work() { return !oracle::kSanitized; }

TEST(Methods, HaveNamesOfTheirOwnAndAreFoundByThem) {
  std::set<std::string> names;
  for (const Method& method : methods()) {
    EXPECT_TRUE(names.insert(method.name).second) << method.name;
    EXPECT_EQ(find_method(method.name)->about, method.about);
  }
  for (const std::string name :
       {"cell/classic", "cell/batch", "cell/segmented", "cell/rows", "cell/plane", "grid/classic", "grid/batch",
        "grid/segmented", "grid/rows", "grid/plane", "engine", "octree"}) {
    EXPECT_TRUE(names.contains(name)) << name;
  }
  EXPECT_FALSE(find_method("none").has_value());
}

TEST(Methods, KeepTheirClaimsWhereNothingIsHard) {
  if (!guarded_runs_work()) GTEST_SKIP() << kNoGuardedRuns;
  for (const std::string scene :
       {"uniform:n=600,moving=0.5,churn=0.05,density=0.5,steps=12", "lattice:n=400,steps=8"}) {
    const KnownScript known = know_script(scene, 100);
    for (const Method& method : methods()) {
      SCOPED_TRACE(method.name + " in " + scene);
      const Trial trial = try_method(method, known, kBudget);
      EXPECT_EQ(trial.error, "");
      EXPECT_EQ(trial.steps + 1, known.script.steps.size());
      EXPECT_GT(trial.true_pairs, 500U);
      EXPECT_EQ(trial.missed_pairs, 0U);
      if (method.claim == Claim::kExact) {
        EXPECT_EQ(verdict_name(trial.verdict), "exact");
        EXPECT_EQ(trial.extra_pairs, 0U);
      }
    }
  }
}

// 8000 widths in 16 bits: an eighth of a width.
TEST(Methods, QuantisedBoxesAreASuperset) {
  if (!guarded_runs_work()) GTEST_SKIP() << kNoGuardedRuns;
  if (!find_method("bullet/axis16")) GTEST_SKIP() << "built without Bullet (Debian: libbullet-dev)";
  const KnownScript known = know_script("clusters:n=500,clusters=8,spread=0.0002,density=1e-9,moving=1,steps=5", 5);
  const Trial trial = try_method(*find_method("bullet/axis16"), known, kBudget);
  EXPECT_EQ(verdict_name(trial.verdict), "superset");
  EXPECT_EQ(trial.missed_pairs, 0U);
  EXPECT_GT(trial.extra_pairs, 100U);
}

TEST(Methods, TheEngineIsExactInEveryRegime) {
  if (!guarded_runs_work()) GTEST_SKIP() << kNoGuardedRuns;
  std::size_t turn = 0;
  for (const Regime& regime : regimes()) {
    for (const std::string& value : regime.values) {
      const std::string scene = scene_at(regime, value, 250, 6);
      const KnownScript known = know_script(scene, 6);
      for (const Method& method : methods()) {
        if (method.name != "engine" && !method.name.starts_with("grid/")) continue;
        // Every other scene for each, if not all are asked for; the engine has them all.
        if (method.name != "engine" && ++turn % 2 != 0 && !oracle::plays_all()) continue;
        const Trial trial = try_method(method, known, kBudget);
        EXPECT_EQ(verdict_name(trial.verdict), "exact") << method.name << " in " << scene << ": " << trial.error;
        EXPECT_EQ(trial.refused_boxes, known.bad_boxes) << method.name << " in " << scene;
      }
    }
  }
}

TEST(Regimes, AreCalmAtFirstAndHardAtLast) {
  std::set<std::string> ids;
  for (const Regime& regime : regimes()) {
    SCOPED_TRACE(regime.id);
    EXPECT_TRUE(ids.insert(regime.id).second);
    ASSERT_GE(regime.values.size(), 2U);
    const KnownScript first = know_script(scene_at(regime, regime.values.front(), 300, 5), 5);
    const KnownScript last = know_script(scene_at(regime, regime.values.back(), 300, 5), 5);
    EXPECT_EQ(first.script.steps.size(), 6U);
    EXPECT_EQ(first.bad_boxes, 0U);
    EXPECT_TRUE(first.script.steps[3].updated_boxes != last.script.steps[3].updated_boxes ||
                first.script.steps[3].inserted_boxes != last.script.steps[3].inserted_boxes);
  }
  EXPECT_EQ(know_script(scene_at(*std::find_if(regimes().begin(), regimes().end(),
                                               [](const Regime& regime) { return regime.id == "point"; }),
                                 "0", 100, 1),
                        1)
                .pairs[0]
                .size(),
            100U * 99 / 2);
}

/// Tells of some pairs only, or of some that are none, or throws.
class WrongSystem final : public baselines::System {
 public:
  enum class Fault { kMisses, kInvents, kThrows, kHogs, kLingers };
  static constexpr int kLastQuickStep = 4;
  static constexpr double kLong = 0.6;  // seconds
  explicit WrongSystem(Fault fault) : fault_(fault) {}

  void queue(const ScriptStep&) override {}
  void step() override {
    if (fault_ == Fault::kThrows) throw std::runtime_error("out of ideas");
    while (fault_ == Fault::kHogs) hoard_.emplace_back(1 << 20, 'x');
    const ThreadStopwatch time;
    while (fault_ == Fault::kLingers && steps_ == kLastQuickStep + 1 && time.seconds() < kLong) {
    }
    ++steps_;
  }
  [[nodiscard]] std::vector<baselines::ObjectPair> pairs() const override {
    if (fault_ == Fault::kMisses) return {};
    std::vector<baselines::ObjectPair> all;
    for (std::uint32_t a = 0; a < 100; ++a) {
      for (std::uint32_t b = a + 1; b < 100; ++b) all.push_back({b, a});
    }
    return all;
  }

 private:
  Fault fault_;
  int steps_ = 0;
  std::vector<std::string> hoard_;
};

Trial try_fault(WrongSystem::Fault fault, const KnownScript& known, const RunBudget& budget) {
  Method method;
  method.make = [fault](const SceneScript&, std::uint64_t) { return std::make_unique<WrongSystem>(fault); };
  return try_method(method, known, budget);
}

TEST(MethodTrial, NamesWhatIsWrong) {
  if (!guarded_runs_work()) GTEST_SKIP() << kNoGuardedRuns;
  const KnownScript known = know_script("uniform:n=100,moving=1,churn=0,density=0.5,steps=3", 3);
  const auto verdict = [&](WrongSystem::Fault fault) { return try_fault(fault, known, {std::uint64_t{64} << 20, 60}); };
  EXPECT_EQ(verdict_name(verdict(WrongSystem::Fault::kMisses).verdict), "misses");
  EXPECT_EQ(verdict(WrongSystem::Fault::kMisses).missed_pairs, verdict(WrongSystem::Fault::kInvents).true_pairs);
  EXPECT_EQ(verdict_name(verdict(WrongSystem::Fault::kInvents).verdict), "superset");
  EXPECT_EQ(verdict(WrongSystem::Fault::kInvents).reported_pairs, 4U * 100 * 99 / 2);
  EXPECT_EQ(verdict_name(verdict(WrongSystem::Fault::kThrows).verdict), "error");
  EXPECT_EQ(verdict(WrongSystem::Fault::kThrows).error, "out of ideas");
  EXPECT_EQ(verdict_name(verdict(WrongSystem::Fault::kHogs).verdict), "memory");
}

TEST(MethodTrial, TellsWhoRefusesAStepForWantOfMemory) {
  if (!guarded_runs_work()) GTEST_SKIP() << kNoGuardedRuns;
  const std::string scene = scene_at(memory_regime(), "", 300, 3);
  const KnownScript known = know_script(scene, 3);
  const auto verdict = [&](const char* method, std::uint64_t mb) {
    return verdict_name(try_method(*find_method(method), known, {mb << 20, 60}).verdict);
  };
  EXPECT_EQ(verdict("engine", 256), "exact");
  EXPECT_EQ(verdict("engine", 8), "exact") << "it keeps no deltas where it sweeps";
  EXPECT_EQ(verdict("engine", 1), "budget") << "44850 pairs";
  EXPECT_EQ(verdict("grid/batch", 8), "budget");
}

TEST(MethodTrial, TellsWhoTakesBadInput) {
  if (!guarded_runs_work()) GTEST_SKIP() << kNoGuardedRuns;
  const KnownScript known = know_script("bad:n=200,steps=5", 5);
  ASSERT_GT(known.bad_boxes, 5U);
  const Trial engine = try_method(*find_method("engine"), known, kBudget);
  EXPECT_EQ(verdict_name(engine.verdict), "exact");
  EXPECT_EQ(engine.refused_boxes, known.bad_boxes);
  EXPECT_EQ(verdict_name(try_method(*find_method("octree"), known, kBudget).verdict), "exact");
  // A cell leaves that to who owns it.
  EXPECT_NE(verdict_name(try_method(*find_method("cell/plane"), known, kBudget).verdict), "exact");
}

TEST(MethodTrial, EndsEarlyWithWhatItCameTo) {
  if (!guarded_runs_work()) GTEST_SKIP() << kNoGuardedRuns;
  const KnownScript known = know_script("uniform:n=10,steps=30", 30);
  const Trial trial = try_fault(WrongSystem::Fault::kLingers, known, {std::uint64_t{1} << 30, 2 * WrongSystem::kLong});
  EXPECT_EQ(verdict_name(trial.verdict), "time");
  EXPECT_EQ(trial.steps, WrongSystem::kLastQuickStep + 1U);
  EXPECT_GE(trial.most_step_ms, 1e3 * WrongSystem::kLong);
  const Trial whole = try_fault(WrongSystem::Fault::kLingers, known, {std::uint64_t{1} << 30, 60});
  EXPECT_EQ(whole.steps, 30U);
}

TEST(NarrowPhase, CountsTheCandidatesThatTouch) {
  const baselines::PlacedPairs candidates = narrow_phase_candidates();
  EXPECT_GT(candidates.size(), 2000U);
#ifdef SWEEPGRID_WITH_BULLET
  const std::size_t bullet = baselines::bullet_touching(candidates);
  EXPECT_GT(bullet, candidates.size() / 10);
  EXPECT_LT(bullet, candidates.size());
#ifdef SWEEPGRID_WITH_FCL
  // In float, near misses may be taken either way.
  const auto fcl = static_cast<double>(baselines::fcl_touching(candidates));
  EXPECT_NEAR(static_cast<double>(bullet), fcl, 0.01 * fcl);
#endif
#endif
}

TEST(NarrowPhase, HasAPriceWithItsSource) {
  const NarrowPhasePrice price = default_narrow_phase_price();
  EXPECT_GT(price.ns, 1);
  EXPECT_LT(price.ns, 1e6);
  EXPECT_LE(price.low_ns, price.ns);
  EXPECT_LE(price.ns, price.high_ns);
  EXPECT_NE(price.source.find("box-box"), std::string::npos);
  EXPECT_THROW(measure_narrow_phase("none"), std::invalid_argument);
}

}  // namespace
}  // namespace sweepgrid::accuracy::accuracy_methods_test
