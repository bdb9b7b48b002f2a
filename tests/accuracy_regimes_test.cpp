// The regimes of the stability map at small sizes: the engine is exact in all of them, by brute force after every step,
// and what it does there is bounded relative to what it does where the regime is calm.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <sweepgrid/engine/engine.hpp>

#include "accuracy/regimes.hpp"
#include "scenes/open_scene.hpp"
#include "scenes/rounded_step.hpp"

namespace sweepgrid::accuracy::accuracy_regimes_test {
namespace {

constexpr std::uint64_t kObjects = 500;
constexpr std::uint64_t kSteps = 8;

/// What a step did, in about nanoseconds: exact counts by what each takes. The same on
/// every machine, so it may decide a test.
double work_of(const StepCounters& step) {
  const auto sum = [](double weight, auto... counts) { return weight * static_cast<double>((counts + ...)); };
  return sum(25, step.updates, step.inserts, step.erases) + sum(15, step.cell_ops) + sum(10, step.cells_drained) +
         sum(0.2, step.cells.box_tests) + sum(12, step.cells.deltas) + sum(20, step.begins, step.ends) +
         sum(1, step.cells.swaps, step.cells.endpoints_visited, step.cells.endpoints_sorted, step.cells.search_steps);
}

/// A scene played: what it cost in the steps after the start, and whether all of it was right.
struct Outcome {
  double work = 0;
  double pairs = 0;  ///< after the steps, summed
  std::string fault;

  [[nodiscard]] double per_object() const { return work / kObjectSteps; }
  [[nodiscard]] double per_object_and_pair() const { return work / (kObjectSteps + pairs); }

 private:
  static constexpr double kObjectSteps = static_cast<double>(kObjects * kSteps);
};

/// An engine beside the boxes that it was told of.
template <class Scalar, int Dim>
class Play {
 public:
  using BoxType = Box<Scalar, Dim>;
  using PairList = std::vector<std::pair<std::uint64_t, std::uint64_t>>;

  static Outcome run(const std::string& scene, StepMethod method) {
    Play play(method);
    const auto source = open_scene(scene + ",dim=" + std::to_string(Dim));
    SceneStep step;
    Outcome outcome;
    for (std::uint64_t number = 0; source->next(step) && outcome.fault.empty(); ++number) {
      outcome.fault = play.step(step);
      if (!outcome.fault.empty()) outcome.fault = scene + ", step " + std::to_string(number) + ": " + outcome.fault;
      if (number == 0) continue;
      outcome.work += work_of(play.engine_.stats().step);
      outcome.pairs += static_cast<double>(play.pairs_.size());
    }
    return outcome;
  }

 private:
  explicit Play(StepMethod method) : engine_(on_one_thread(method)) {}

  static Config on_one_thread(StepMethod method) {
    Config config;
    config.step_method = method;
    config.threads = 1;
    return config;
  }

  // What is wrong after the step, if anything.
  std::string step(const SceneStep& changes) {
    for (const SceneKey key : changes.erased) engine_.erase(key), boxes_.erase(key);
    for (std::size_t i = 0; i < changes.inserted.size(); ++i) {
      const auto box = round_box<Scalar, Dim>(changes.inserted_boxes[i]);
      engine_.insert(changes.inserted[i], box);
      boxes_[changes.inserted[i]] = box;
    }
    for (std::size_t i = 0; i < changes.updated.size(); ++i) {
      const auto box = round_box<Scalar, Dim>(changes.updated_boxes[i]);
      if (is_taken(changes.updated[i], box) != box.valid()) return "a box was taken or refused wrongly";
      if (box.valid()) boxes_[changes.updated[i]] = box;
    }
    const std::string fault = apply(engine_.step());
    if (!fault.empty()) return fault;
    if (pairs_ != true_pairs()) return "the events do not add up to the pairs that overlap";
    return list(engine_.pairs()) == pairs_ ? "" : "pairs() differs from the events";
  }

  bool is_taken(SceneKey key, const BoxType& box) {
    try {
      engine_.update(key, box);
    } catch (const std::invalid_argument&) {
      return false;
    }
    return true;
  }

  std::string apply(const Events<std::uint64_t>& events) {
    const PairList ends = list(events.ends);
    const PairList begins = list(events.begins);
    const auto twice = [](const PairList& all) { return std::adjacent_find(all.begin(), all.end()) != all.end(); };
    if (twice(ends) || twice(begins)) return "an event came twice";
    if (!std::includes(pairs_.begin(), pairs_.end(), ends.begin(), ends.end())) return "a pair ended that was none";
    PairList known;
    std::set_intersection(pairs_.begin(), pairs_.end(), begins.begin(), begins.end(), std::back_inserter(known));
    if (!known.empty()) return "a pair began that was one already";
    PairList rest;
    std::set_difference(pairs_.begin(), pairs_.end(), ends.begin(), ends.end(), std::back_inserter(rest));
    pairs_.clear();
    std::merge(rest.begin(), rest.end(), begins.begin(), begins.end(), std::back_inserter(pairs_));
    return {};
  }

  static PairList list(const std::vector<Pair<std::uint64_t>>& pairs) {
    PairList list;
    for (const auto& pair : pairs)
      list.emplace_back(std::min(pair.first, pair.second), std::max(pair.first, pair.second));
    std::sort(list.begin(), list.end());
    return list;
  }

  [[nodiscard]] PairList true_pairs() const {
    PairList pairs;
    const std::vector<std::pair<SceneKey, BoxType>> all(boxes_.begin(), boxes_.end());
    for (auto a = all.begin(); a != all.end(); ++a) {
      for (auto b = a + 1; b != all.end(); ++b) {
        bool apart = false;
        for (int axis = 0; axis < Dim; ++axis) {
          apart |= a->second.min[axis] > b->second.max[axis] || b->second.min[axis] > a->second.max[axis];
        }
        if (!apart) pairs.emplace_back(a->first, b->first);
      }
    }
    return pairs;
  }

  Engine<Scalar, Dim> engine_;
  std::map<SceneKey, BoxType> boxes_;
  PairList pairs_;
};

/// What steps through cells may do in the worst setting of a regime, in times of what they do in the calm one. Stated a
/// little above what was counted, so that half as much again fails: in either direction, so that the table stays true.
struct Bound {
  const char* regime;
  double flat;  ///< in two dimensions, per object and step
  double deep;  ///< in three
  /// In the last setting, per object and pair that overlaps: for regimes in which most of the work is the pairs.
  double flat_pairs = 0;
  double deep_pairs = 0;
};
constexpr Bound kBounds[] = {
    {"speed", 1.6, 1.75},
    {"teleport", 1.6, 1.75},
    {"wall", 1.36, 1.32},
    {"pile", 1.35, 1.33},
    {"clusters", 2.3, 1.55, 0.24, 0.037},
    {"covers", 2.7, 1.73, 0.033, 0.023},
    {"sizes", 2.1, 1.42},
    {"far", 1.1, 1.1},
    {"lattice", 1.5, 2.3},
    {"thin", 1.1, 1.1},
    {"churn", 2.2, 2.22},
    {"crossing", 1.53, 1.62},
    {"point", 10.2, 12.3, 0.19, 0.105},
    {"limits", 1.1, 1.1},
    {"tiny", 1.1, 1.1},
    {"infinite", 2.9, 2.5},
    {"nan", 1.1, 1.1},
    {"inverted", 1.1, 1.1},
};
constexpr double kSlack = 1.5;

const Bound* bound_of(const Regime& regime) {
  const Bound* const found = std::find_if(std::begin(kBounds), std::end(kBounds),
                                          [&](const Bound& bound) { return bound.regime == regime.id; });
  return found == std::end(kBounds) ? nullptr : found;
}

void expect_near_below(double cost, double bound, const std::string& what) {
  EXPECT_LE(cost, bound) << what << " costs more than the table allows";
  EXPECT_GT(cost * kSlack, bound) << what << " costs so much less that the table is to be tightened";
}

struct Space {
  const char* name;
  Outcome (*play)(const std::string& scene, StepMethod method);
  bool flat;
};
constexpr Space kSpaces[] = {{"float2", Play<float, 2>::run, true},
                             {"float3", Play<float, 3>::run, false},
                             {"double2", Play<double, 2>::run, true},
                             {"double3", Play<double, 3>::run, false}};

using Case = std::tuple<Regime, Space>;

class RegimesTest : public testing::TestWithParam<Case> {};

TEST_P(RegimesTest, EngineStaysExactAndNotMuchDearerThanCalm) {
  const auto& [regime, space] = GetParam();
  const Bound* const bound = bound_of(regime);
  ASSERT_NE(bound, nullptr);
  std::vector<Outcome> outcomes;
  double worst = 0;
  for (const std::string& value : regime.values) {
    outcomes.push_back(space.play(scene_at(regime, value, kObjects, kSteps), StepMethod::kCells));
    EXPECT_EQ(outcomes.back().fault, "");
    worst = std::max(worst, outcomes.back().per_object() / outcomes.front().per_object());
  }
  expect_near_below(worst, space.flat ? bound->flat : bound->deep, "an object in a step");
  const double pairs_bound = space.flat ? bound->flat_pairs : bound->deep_pairs;
  if (pairs_bound == 0) return;
  const double per_pair = outcomes.back().per_object_and_pair() / outcomes.front().per_object_and_pair();
  expect_near_below(per_pair, pairs_bound, "an object or a pair in a step");
}

INSTANTIATE_TEST_SUITE_P(Accuracy, RegimesTest,
                         testing::Combine(testing::ValuesIn(regimes()), testing::ValuesIn(kSpaces)),
                         [](const testing::TestParamInfo<Case>& given) {
                           return std::get<Regime>(given.param).id + "_" + std::get<Space>(given.param).name;
                         });

TEST_P(RegimesTest, EngineStaysExactHoweverItSteps) {
  const auto& [regime, space] = GetParam();
  for (const StepMethod method : {StepMethod::kSweep, StepMethod::kAuto}) {
    EXPECT_EQ(space.play(scene_at(regime, regime.values.back(), kObjects, kSteps), method).fault, "");
  }
}

TEST(RegimeBounds, AreThoseOfTheRegimes) { EXPECT_EQ(std::size(kBounds), regimes().size()); }

}  // namespace
}  // namespace sweepgrid::accuracy::accuracy_regimes_test
