// Tuning: what is sampled, what promises allow, and what is chosen, with times that are made up.
#include "tune/tuner.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sweepgrid/engine/config_json.hpp>

#include "scenes/scene_error.hpp"
#include "study/accuracy/known_scene.hpp"
#include "tune/contest.hpp"
#include "tune/exhaustive.hpp"
#include "tune/reasons.hpp"
#include "tune/tune_json.hpp"

namespace sweepgrid::tune::tune_test {
namespace {

using accuracy::TruthKind;
using Axes = std::vector<std::size_t>;

SceneSample sample_of(const std::string& scene, TruthKind truth = TruthKind::kInstants) {
  return take_sample({scene, {}, {}}, truth);
}

Demand demand_of(TruthKind truth = TruthKind::kInstants) {
  Demand demand;
  demand.truth = truth;
  demand.narrow_ns = 100;
  demand.narrow_source = "made up";
  return demand;
}

/// Costs that are made up, with one step and no pairs unless a test says otherwise.
class MadeUp {
 public:
  using Cost = std::function<double(const Candidate&)>;
  using Pairs = std::function<void(const Candidate&, Trial&)>;

  explicit MadeUp(Cost cost, Pairs pairs = {}) : cost_(std::move(cost)), pairs_(std::move(pairs)) {}

  [[nodiscard]] PlayRound player() {
    return [this](const Candidate& candidate, Trial& trial, double) {
      played_.insert(candidate.name());
      seen_.push_back(candidate);
      ++trial.rounds;
      trial.least_ms = {cost_(candidate)};
      if (pairs_) pairs_(candidate, trial);
    };
  }

  [[nodiscard]] std::size_t count_played(const std::function<bool(const Candidate&)>& which) const {
    return static_cast<std::size_t>(std::count_if(seen_.begin(), seen_.end(), which));
  }
  [[nodiscard]] const std::set<std::string>& played() const { return played_; }

 private:
  Cost cost_;
  Pairs pairs_;
  std::set<std::string> played_;
  std::vector<Candidate> seen_;
};

TuneResult tune_with(const std::string& scene, const Demand& demand, MadeUp& costs) {
  const SceneSample sample = sample_of(scene, demand.truth);
  return tune(sample, find_facts(sample), demand, costs.player());
}

std::string refusal(const std::string& scene, const Demand& demand, MadeUp& costs) {
  try {
    static_cast<void>(tune_with(scene, demand, costs));
  } catch (const DemandNotMet& error) {
    return error.what();
  }
  return "";
}

const Reason& reason_about(const TuneResult& result, const std::string& about) {
  return *std::find_if(result.reasons.begin(), result.reasons.end(),
                       [&](const Reason& reason) { return reason.about == about; });
}

bool rejected(const TuneResult& result, const std::string& candidate, const std::string& because) {
  return std::any_of(result.rejected.begin(), result.rejected.end(), [&](const Rejection& one) {
    return one.candidate == candidate && one.because.find(because) != std::string::npos;
  });
}

constexpr const char* kUniform = "uniform:n=400,moving=1,churn=0.01,density=0.2,steps=70";
constexpr const char* kFlat = "pile:n=400,moving=1,churn=0,layers=1,density=0.3,steps=20";
constexpr const char* kResting = "resting:n=400,steps=20,density=0.2";
constexpr const char* kFast = "fast:n=400,steps=20,density=0.2";

TEST(Part, IsAPercentageOrAFraction) {
  EXPECT_EQ(parse_part("0"), 0);
  EXPECT_DOUBLE_EQ(parse_part("5%"), 0.05);
  EXPECT_DOUBLE_EQ(parse_part("0.25"), 0.25);
  EXPECT_EQ(parse_part("100%"), 1);
  for (const char* bad : {"", "%", "5 %", "-1%", "101%", "1.5", "nan", "x", "5%%"}) {
    EXPECT_THROW(static_cast<void>(parse_part(bad)), std::invalid_argument) << bad;
  }
}

TEST(WindowPlan, LiesWithinTheSceneAndMeasuresSome) {
  for (std::uint64_t steps = 1; steps < 300; ++steps) {
    std::uint64_t last = 0;
    for (const WindowPlan& plan : plan_windows(steps)) {
      EXPECT_GE(plan.begin, last) << "windows do not share steps";
      EXPECT_GT(plan.measured, 0U);
      last = plan.begin + plan.warm_up + plan.measured;
      EXPECT_LE(last, steps);
    }
    EXPECT_LE(plan_windows(steps).size(), 2U);
  }
  EXPECT_EQ(plan_windows(100).size(), 2U);
}

TEST(SceneSample, HoldsWhatIsTrueOfTheSceneAtThatTime) {
  for (const char* scene : {kUniform, "turning:n=200,steps=70,churn=0.02"}) {
    for (const TruthKind truth : {TruthKind::kInstants, TruthKind::kMotion, TruthKind::kShapes}) {
      const SceneSample whole = take_whole({scene, {}, {}}, truth);
      ASSERT_EQ(whole.windows.size(), 1U);
      EXPECT_EQ(whole.measured(), 70U);
      const SceneSample sample = sample_of(scene, truth);
      ASSERT_EQ(sample.windows.size(), 2U);
      EXPECT_EQ(sample.measured(), 16U);
      for (const Window& window : sample.windows) {
        const auto& pairs = window.scene.truths.at(0).pairs;
        ASSERT_EQ(pairs.size(), window.scene.steps.size());
        for (std::size_t k = 1; k < pairs.size(); ++k) {
          EXPECT_EQ(pairs[k], whole.windows[0].scene.truths[0].pairs[window.begin + k]) << scene << " " << k;
          EXPECT_FALSE(pairs[k].empty());
        }
      }
    }
  }
}

TEST(SceneSample, ReadsNoMoreStepsThanAskedForAndRefusesBadInput) {
  EXPECT_EQ(take_whole({kUniform, {}, 5}, TruthKind::kInstants).measured(), 5U);
  EXPECT_THROW(static_cast<void>(sample_of("uniform:n=10,steps=0")), SceneError);
  EXPECT_THROW(static_cast<void>(sample_of("bad:n=400,steps=20")), SceneError);
  EXPECT_THROW(static_cast<void>(sample_of("huge:n=100,steps=4")), SceneError);
}

TEST(SceneFacts, AreCounts) {
  const SceneFacts flat = find_facts(sample_of(kFlat));
  EXPECT_GT(flat.pairs, 0);
  EXPECT_EQ(flat.pairs_without[2], flat.pairs);
  EXPECT_GT(flat.pairs_without[0], 2 * flat.pairs);
  EXPECT_EQ(flat.objects, 400);
  EXPECT_EQ(flat.updates, 400);
  EXPECT_FALSE(flat.floats);
  EXPECT_NEAR(flat.most_edge / flat.least_edge, 1, 1e-9);

  const SceneSample resting = sample_of(kResting);
  const SceneFacts facts = find_facts(resting);
  EXPECT_LT(facts.displacement, 0.01);
  EXPECT_DOUBLE_EQ(updates_outside(resting, 0), facts.updates);
  EXPECT_LT(updates_outside(resting, 0.02), 0.1 * facts.updates);
  EXPECT_EQ(updates_outside(resting, 100), 0);

  const SceneFacts fast = find_facts(sample_of(kFast));
  EXPECT_GT(fast.most_displacement, 1.5);
  EXPECT_TRUE(find_facts(sample_of("lattice:n=100,steps=4,offset=8")).floats);
}

/// Cubes of width 1 in a row, far apart, of which the first so many go by `shift` along y in every step.
SceneSample row_of(std::uint32_t objects, std::uint32_t moving, double shift) {
  SceneSample sample;
  sample.width = 1;
  Window& window = sample.windows.emplace_back();
  window.warm_up = 8;
  window.scene.objects = objects;
  for (int k = 0; k <= 16; ++k) {
    study::KnownStep& step = window.scene.steps.emplace_back();
    for (std::uint32_t object = 0; object < (k == 0 ? objects : moving); ++object) {
      const double x = 10.0 * object;
      (k == 0 ? step.inserted : step.updated).push_back(object);
      (k == 0 ? step.inserted_boxes : step.updated_boxes).push_back({{x, k * shift, 0}, {x + 1, k * shift + 1, 1}});
    }
  }
  return sample;
}

TEST(SceneFacts, SpeedsAreThoseThatMarginsFollow) {
  EXPECT_NEAR(mean_speed(row_of(10, 10, 0.25), 1), 0.25, 1e-9);
  EXPECT_NEAR(mean_speed(row_of(10, 1, 0.25), 4), 0.025, 1e-9);
  EXPECT_EQ(mean_speed(row_of(10, 0, 0.25), 1), 0);
  SceneSample jumps = row_of(10, 1, 0.25);
  for (std::size_t k = 10; k <= 16; ++k) {
    SceneBox& box = jumps.windows[0].scene.steps[k].updated_boxes[0];
    box.min[1] += 100;
    box.max[1] += 100;
  }
  EXPECT_NEAR(mean_speed(jumps, 1), 0.025, 1e-9) << "an object that jumps once is no faster";
}

TEST(Reasons, MarginsByStepsAreRuledOutByWhatObjectsGoInTheMean) {
  const EnvelopeOptions envelope{.margin_steps = 6, .stride = 4, .on_violation = OnViolation::kQuery};
  const auto why_not = [&](const SceneSample& sample) {
    return why_not_worthwhile(envelope, sample, find_facts(sample));
  };
  EXPECT_EQ(why_not(row_of(100, 1, 2)), "") << "a single object is fast";
  EXPECT_EQ(why_not(row_of(100, 100, 0.1)), "");
  EXPECT_EQ(why_not(row_of(100, 100, 0.5)), "margins would be 3 widths in the mean: objects go by 0.5 in a step");
  EXPECT_EQ(why_not(row_of(100, 0, 0)), "nothing moves");
}

TEST(Candidate, GivesMarginsInTheUnitsOfTheEngine) {
  const SceneSample sample = sample_of("uniform:n=100,width=4,moving=1,steps=4");
  Candidate candidate{{0, 1, 2}, Door::kDouble, EnvelopeOptions{.margin = 0.5}, {}};
  EXPECT_DOUBLE_EQ(candidate.setup(sample, 1).config.envelope->margin, 2);
  candidate.door = Door::kInt16;
  const EngineSetup setup = candidate.setup(sample, 1);
  EXPECT_DOUBLE_EQ(setup.config.envelope->margin, 2 / setup.treatment.resolution);
  EXPECT_LT(setup.treatment.resolution, 1);
}

TEST(Candidate, MayMeetWhatItPromises) {
  const SceneInfo scene = sample_of(kUniform).info;
  const CandidateSpace space = candidate_space(scene);
  Demand demand = demand_of();
  const auto envelopes = [&] {
    std::vector<std::string> names;
    for (const EnvelopeChoice& envelope : space.envelopes) {
      if (may_meet({{0, 1, 2}, Door::kDouble, envelope, {}}, scene, demand)) names.push_back(envelope_name(envelope));
    }
    return names;
  };
  const auto has = [&](const std::string& name) {
    const std::vector<std::string> names = envelopes();
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  EXPECT_TRUE(has("no envelopes") && has("margin 0.1") && has("stride 4, margin of 6 steps, queries"));
  EXPECT_FALSE(has("stride 4") || has("stride 4, margin of 6 steps")) << "these only report what is outside";
  demand.extra = 0;
  EXPECT_TRUE(has("no envelopes") && has("margin 0.1, exact"));
  EXPECT_FALSE(has("margin 0.1") || has("swept"));
  EXPECT_FALSE(may_meet({{0, 1}, Door::kDouble, {}, {}}, scene, demand)) << "an axis left out";
  EXPECT_FALSE(may_meet({{0, 1, 2}, Door::kFloatNearest, {}, {}}, scene, demand)) << "rounded";
  SceneInfo recording = scene;
  recording.format = "aabbs";
  EXPECT_TRUE(may_meet({{0, 1, 2}, Door::kFloatNearest, {}, {}}, recording, demand)) << "floats as they are";
  demand.missed = 0.1;
  demand.extra.reset();
  EXPECT_TRUE(has("stride 4"));
  demand = demand_of(TruthKind::kMotion);
  EXPECT_EQ(envelopes(), (std::vector<std::string>{"swept", "swept, margin 0.1"}));
}

TEST(Tune, TakesNoLuckForAGuarantee) {
  // Strides that may miss cost nothing and missed nothing.
  MadeUp costs([](const Candidate& candidate) {
    return candidate.envelope && candidate.envelope->stride > 1 &&
                   candidate.envelope->on_violation == OnViolation::kReport
               ? 0.001
               : 1.0;
  });
  const TuneResult result = tune_with(kUniform, demand_of(), costs);
  EXPECT_EQ(result.guarantee, Guarantee::kExact) << "the plainest of those that are as cheap";
  EXPECT_EQ(envelope_name(result.chosen.envelope), "no envelopes");
  EXPECT_TRUE(rejected(result, "stride 4", "may miss"));
  Demand lenient = demand_of();
  lenient.missed = 0.01;
  EXPECT_EQ(tune_with(kUniform, lenient, costs).guarantee, Guarantee::kMayMiss);
  MadeUp missing([](const Candidate& candidate) { return candidate.envelope ? 0.1 : 1.0; },
                 [](const Candidate& candidate, Trial& trial) {
                   trial.true_pairs = trial.reported_pairs = 100;
                   trial.missed_pairs = candidate.envelope ? 2 : 0;
                 });
  EXPECT_EQ(envelope_name(tune_with(kUniform, lenient, missing).chosen.envelope), "no envelopes");
}

TEST(Tune, SweepsForTheTruthBetweenTheSteps) {
  MadeUp costs([](const Candidate& candidate) { return candidate.envelope ? 5.0 : 1.0; });
  const TuneResult result = tune_with(kFast, demand_of(TruthKind::kMotion), costs);
  EXPECT_EQ(envelope_name(result.chosen.envelope), "swept");
  EXPECT_EQ(result.guarantee, Guarantee::kSuperset);
  EXPECT_EQ(costs.count_played([](const Candidate& candidate) { return !candidate.envelope; }), 0U);
  Demand none_extra = demand_of(TruthKind::kMotion);
  none_extra.extra = 0;
  const std::string reason = refusal(kFast, none_extra, costs);
  EXPECT_NE(reason.find("none extra, by a guarantee"), std::string::npos) << reason;
  EXPECT_NE(reason.find("nearest: double; xyz; swept"), std::string::npos) << reason;
}

TEST(Tune, KeepsToTheExtraPairsThatAreAllowed) {
  const auto pairs = [](const Candidate& candidate, Trial& trial) {
    trial.true_pairs = 100;
    const double margin = candidate.envelope && !candidate.envelope->exact ? candidate.envelope->margin : 0;
    trial.extra_pairs = static_cast<std::uint64_t>(200 * margin);
    trial.reported_pairs = 100 + trial.extra_pairs;
  };
  const auto cost = [](const Candidate& candidate) {
    if (!candidate.envelope) return 1.0;
    return 1 - candidate.envelope->margin + (candidate.envelope->exact ? 0.1 : 0);
  };
  MadeUp costs(cost, pairs);
  Demand demand = demand_of();
  EXPECT_EQ(envelope_name(tune_with(kResting, demand, costs).chosen.envelope), "margin 0.4");
  demand.extra = 0.2;
  EXPECT_EQ(envelope_name(tune_with(kResting, demand, costs).chosen.envelope), "margin 0.4, exact");
  demand.extra = 0;
  const TuneResult exact = tune_with(kResting, demand, costs);
  EXPECT_EQ(exact.guarantee, Guarantee::kExact);
  EXPECT_TRUE(rejected(exact, "margin 0.4", "superset only"));
  demand.narrow_ns = 1e5;
  demand.extra.reset();
  EXPECT_EQ(tune_with(kResting, demand, costs).trial.extra_pairs, 0U) << "a dear narrow phase";
}

TEST(Tune, SaysWhatCameNearestWhereNothingMeetsTheDemand) {
  MadeUp costs([](const Candidate&) { return 1; },
               [](const Candidate& candidate, Trial& trial) {
                 trial.true_pairs = 100;
                 trial.extra_pairs = candidate.door == Door::kInt32 ? 50 : 100;
                 trial.reported_pairs = 100 + trial.extra_pairs;
               });
  Demand demand = demand_of();
  demand.extra = 0.1;
  const std::string reason = refusal(kUniform, demand, costs);
  EXPECT_NE(reason.find("no configuration meets the demand"), std::string::npos) << reason;
  EXPECT_NE(reason.find("nearest in the sample: int32; "), std::string::npos) << reason;
  EXPECT_NE(reason.find("33.33 % extra"), std::string::npos) << reason;
}

TEST(Tune, LeavesAnAxisOutOfAFlatSceneAlone) {
  const auto two_are_cheaper = [](const Candidate& candidate) { return candidate.axes.size() == 2 ? 0.5 : 1.0; };
  MadeUp flat(two_are_cheaper);
  const TuneResult result = tune_with(kFlat, demand_of(), flat);
  EXPECT_EQ(result.chosen.axes, (Axes{0, 1}));
  EXPECT_EQ(result.guarantee, Guarantee::kSuperset);
  EXPECT_NE(reason_about(result, "axes").because.find("flat: without z"), std::string::npos);
  MadeUp deep([](const Candidate& candidate) { return candidate.axes.size() == 2 ? 1e-4 : 2e-3; });
  EXPECT_EQ(tune_with(kUniform, demand_of(), deep).chosen.axes, (Axes{0, 1, 2}));
  EXPECT_EQ(deep.count_played([](const Candidate& candidate) { return candidate.axes.size() == 2; }), 0U)
      << "the pairs alone rule it out";
  MadeUp two(two_are_cheaper);
  Demand exact = demand_of();
  exact.extra = 0;
  const TuneResult in_the_plane = tune_with("uniform:n=400,dim=2,steps=10", exact, two);
  EXPECT_EQ(in_the_plane.chosen.axes, (Axes{0, 1}));
  EXPECT_EQ(in_the_plane.guarantee, Guarantee::kExact);
}

TEST(Tune, MeasuresMarginsOnlyWhereTheySaveSomething) {
  const auto margins = [](const Candidate& candidate) {
    return candidate.envelope && candidate.envelope->margin > 0 && candidate.envelope->stride == 1;
  };
  const auto cost = [&](const Candidate& candidate) { return margins(candidate) ? 0.5 : 1.0; };
  MadeUp resting(cost);
  EXPECT_TRUE(margins(tune_with(kResting, demand_of(), resting).chosen));
  MadeUp fast(cost);
  const TuneResult result = tune_with(kFast, demand_of(), fast);
  EXPECT_EQ(
      fast.count_played([&](const Candidate& candidate) { return margins(candidate) && !candidate.envelope->swept; }),
      0U);
  EXPECT_TRUE(rejected(result, "margin 0.1", "would leave the margin"));
  EXPECT_TRUE(rejected(result, "stride 4, margin of 6 steps, queries", "margins would be"));
}

TEST(Tune, FindsWhatIsBestTogetherOnly) {
  MadeUp costs([](const Candidate& candidate) {
    const bool floats = candidate.door == Door::kFloatNearest;
    const std::string cells = cells_name(candidate.cells);
    const bool small = cells == "rows of 8";
    if (small && floats) return 0.5;
    const double numbers = floats ? 1.05 : candidate.door == Door::kDouble ? 1.0 : 2.0;
    return cells == "rows" ? numbers : small ? numbers + 0.1 : 3;
  });
  const TuneResult result = tune_with(kUniform, demand_of(), costs);
  EXPECT_EQ(result.chosen.door, Door::kFloatNearest);
  EXPECT_EQ(result.chosen.cells.population, 8);
}

TEST(Tune, MeasuresFewAndTellsAll) {
  MadeUp costs([](const Candidate& candidate) { return candidate.door == Door::kFloatNearest ? 0.7 : 1.0; });
  const TuneResult result = tune_with(kUniform, demand_of(), costs);
  const CandidateSpace space = candidate_space(sample_of(kUniform).info);
  EXPECT_LT(costs.played().size(), 40U);
  EXPECT_GT(space.axes.size() * space.doors.size() * space.envelopes.size() * space.cells.size(), 3000U);
  ASSERT_EQ(result.reasons.size(), 6U);
  for (const char* about : {"numbers", "axes", "envelopes", "cells", "grid", "guarantee"}) {
    EXPECT_FALSE(reason_about(result, about).because.empty()) << about;
  }
  std::size_t measured = 0;
  for (const Rejection& one : result.rejected) {
    EXPECT_FALSE(one.because.empty());
    measured += one.rounds > 0 ? 1U : 0U;
  }
  EXPECT_EQ(measured + 1, costs.played().size());
}

TEST(RoundPlayer, CountsTheErrorsOfRealEngines) {
  const SceneSample sample = sample_of(kUniform);
  const Demand demand = demand_of();
  const PlayRound play = round_player(sample, demand);
  const auto trial_of = [&](const Candidate& candidate) {
    Trial trial;
    play(candidate, trial, std::numeric_limits<double>::infinity());
    EXPECT_EQ(trial.least_ms.size(), sample.measured());
    return trial;
  };
  const Trial exact = trial_of({{0, 1, 2}, Door::kDouble, {}, {}});
  EXPECT_GT(exact.true_pairs, 0U);
  EXPECT_EQ(exact.missed_pairs + exact.extra_pairs, 0U);
  EXPECT_LE(exact.grids, 1U) << "a uniform scene has one level, and none where steps sweep";
  for (const Candidate& candidate :
       {Candidate{{0, 1}, Door::kFloatOutward, {}, {}},
        Candidate{{0, 1, 2}, Door::kInt16, EnvelopeOptions{.margin = 0.4}, {CellKind::kBatch, 8}},
        Candidate{{0, 1, 2},
                  Door::kInt32,
                  EnvelopeOptions{.margin_steps = 6, .stride = 4, .on_violation = OnViolation::kQuery},
                  {}}}) {
    const Trial trial = trial_of(candidate);
    EXPECT_EQ(trial.missed_pairs, 0U) << candidate.name();
    EXPECT_GT(trial.extra_pairs, 0U) << candidate.name();
    EXPECT_EQ(trial.reported_pairs, trial.true_pairs + trial.extra_pairs);
    EXPECT_EQ(trial.true_pairs, exact.true_pairs);
  }
  const Trial missing = trial_of({{0, 1, 2}, Door::kDouble, EnvelopeOptions{.stride = 8}, {}});
  EXPECT_GT(missing.missed_pairs, 0U);
  Trial hopeless;
  play({{0, 1, 2}, Door::kDouble, {}, {}}, hopeless, 0);
  EXPECT_FALSE(hopeless.given_up.empty());
  EXPECT_FALSE(met(hopeless, demand));
}

TEST(Exhaustive, FindsTheBestAndRulesOutNothingElse) {
  const SceneSample whole = take_whole({kUniform, {}, 3}, TruthKind::kInstants);
  const CandidateSpace space = candidate_space(whole.info);
  Demand demand = demand_of();
  const std::string best = Candidate{{0, 2}, Door::kInt16, space.envelopes.back(), {CellKind::kBatch, 32}}.name();
  MadeUp costs([&](const Candidate& candidate) { return candidate.name() == best ? 0.5 : 1.0; });
  const Candidate chosen{{0, 1, 2}, Door::kDouble, {}, {}};
  const ExhaustiveResult all = search_exhaustively(whole, demand, chosen, costs.player(), 2);
  EXPECT_EQ(all.best.name(), best);
  EXPECT_EQ(all.chosen_trial.total_ms(demand.narrow_ns), 1);
  EXPECT_EQ(all.ruled_out, 0U);
  std::size_t envelopes = 0;
  for (const EnvelopeChoice& envelope : space.envelopes) {
    envelopes += may_meet({{0, 1, 2}, Door::kDouble, envelope, {}}, whole.info, demand) ? 1U : 0U;
  }
  EXPECT_EQ(all.measured, space.axes.size() * space.doors.size() * envelopes * space.cells.size());

  MadeUp crowded([](const Candidate&) { return 1; },
                 [](const Candidate& candidate, Trial& trial) {
                   trial.true_pairs = 1;
                   trial.reported_pairs = candidate.axes.size() == 3 ? 1 : 100000;
                 });
  const ExhaustiveResult deep = search_exhaustively(whole, demand, chosen, crowded.player(), 1);
  EXPECT_EQ(deep.measured + deep.ruled_out, all.measured);
  EXPECT_EQ(deep.measured, all.measured / 4 + 3) << "one candidate told that two axes are too few";
}

TEST(TuneJson, IsASetupWithTheReasons) {
  MadeUp costs([](const Candidate& candidate) { return candidate.door == Door::kInt16 ? 0.5 : 1.0; });
  Tuning tuning;
  tuning.scene.name = kResting;
  tuning.demand = demand_of();
  tuning.sample = sample_of(kResting);
  tuning.facts = find_facts(tuning.sample);
  tuning.result = tune(tuning.sample, tuning.facts, tuning.demand, costs.player());
  tuning.seconds = 1;
  const nlohmann::ordered_json json = tune_json(tuning);
  EXPECT_EQ(json.at("schema"), "sweepgrid-setup");
  EXPECT_EQ(json.at("scalar"), "int16");
  EXPECT_EQ(json.at("axes"), nlohmann::json({0, 1, 2}));
  EXPECT_GT(json.at("quantizer").at("resolution"), 0);
  const Config config = json.at("config");
  EXPECT_EQ(config.threads, 1);
  EXPECT_EQ(json.at("tune").at("reasons").size(), 6U);
  EXPECT_EQ(json.at("tune").at("rejected").size(), tuning.result.rejected.size());
  EXPECT_EQ(json.at("tune").at("sample").at("windows").size(), 1U);
  EXPECT_NE(tune_text(tuning).find("chosen: int16; xyz; no envelopes; rows"), std::string::npos);
}

}  // namespace
}  // namespace sweepgrid::tune::tune_test
