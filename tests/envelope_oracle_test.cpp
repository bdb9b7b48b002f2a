// With margins and strides no pair of the client's boxes is missed, or the report says whose; with `exact` the events
// are those of an engine without envelopes, for every kind of cell, reduction, type, number of threads and way to call.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "envelope_play.hpp"

namespace sweepgrid::oracle::envelope_oracle_test {
namespace {

struct Setting {
  const char* name;
  EnvelopeOptions options;
};

// Boxes in the scenes are about 10 wide, and jitter by a quarter of that.
const std::vector<Setting>& settings() {
  static const std::vector<Setting> all = {
      {"margin", {.margin = 2}},
      {"tiny margin", {.margin = 1e-3}},
      {"no margin", {}},
      {"huge margin", {.margin = 1e9}},
      {"margin by displacement", {.margin_steps = 1}},
      {"exact", {.margin = 2, .exact = true}},
      {"exact without a margin", {.exact = true}},
      {"exact with a huge margin", {.margin = 60, .exact = true}},
      {"stride", {.stride = 3}},
      {"stride with a margin", {.margin = 4, .stride = 3}},
      {"stride that queries", {.margin = 4, .stride = 4, .on_violation = OnViolation::kQuery}},
      {"stride with displacements", {.margin_steps = 2, .stride = 2}},
      {"exact stride", {.margin = 4, .stride = 3, .exact = true}},
      {"exact stride that queries", {.margin = 4, .stride = 3, .on_violation = OnViolation::kQuery, .exact = true}},
      {"swept", {.swept = true}},
      {"swept with a margin", {.margin = 2, .swept = true}},
      {"swept with a stride", {.margin = 1, .swept = true, .stride = 2}},
  };
  return all;
}

template <class Scalar, int Dim>
std::string play_settings(const SceneRegime& regime, std::size_t turn) {
  for (const Setting& setting : settings()) {
    ++turn;
    if ((turn + first_turn(regime.name)) % ((kSanitized ? 3 : 1) * (plays_all() ? 1 : 3)) != 0) continue;
    const int threads = turn % 4 == 0 ? 3 : 1;
    const std::size_t k = turn % kKinds.size();
    const std::size_t r = turn / kKinds.size() % 2;
    std::size_t g = turn % kGrids.size();
    while (!kGrids[g].suits(regime.place, kReductions[r])) g = (g + 1) % kGrids.size();
    // Without levels, wide envelopes are in too many cells of a fine grid.
    const bool wide = setting.options.margin > 5 || setting.options.margin_steps > 0 || setting.options.swept;
    if (wide && kReductions[r] == Reduction::kWitnessCounts) g = 2;  // the one with many objects per cell
    auto config = kGrids[g].template config<Dim>(kKinds[k], make_executor(threads), kReductions[r]);
    config.envelope = setting.options;
    const Calls calls = kCalls[(turn + k) % kCalls.size()];
    const std::string wrong =
        play_envelopes<Scalar, Dim>(config, SceneScript<Scalar, Dim>(regime, turn), regime.steps, calls);
    if (!wrong.empty()) {
      return std::string(setting.name) + ", " + kKindNames[k] + " cells, " + kReductionNames[r] + ", " +
             kGrids[g].name + ", " + std::to_string(threads) + " threads, calls " +
             std::to_string(static_cast<int>(calls)) + ", seed " + std::to_string(turn) + ": " + wrong;
    }
  }
  return {};
}

std::string name_of(const ::testing::TestParamInfo<SceneRegime>& info) { return info.param.name; }

class EnvelopeOracle : public ::testing::TestWithParam<SceneRegime> {};

TEST_P(EnvelopeOracle, MissesNothingInFloat3) { EXPECT_EQ((play_settings<float, 3>(GetParam(), 0)), ""); }
TEST_P(EnvelopeOracle, MissesNothingInDouble2) { EXPECT_EQ((play_settings<double, 2>(GetParam(), 5)), ""); }
TEST_P(EnvelopeOracle, MissesNothingInInt2) { EXPECT_EQ((play_settings<std::int32_t, 2>(GetParam(), 11)), ""); }
TEST_P(EnvelopeOracle, MissesNothingInShort3) { EXPECT_EQ((play_settings<std::int16_t, 3>(GetParam(), 3)), ""); }
INSTANTIATE_TEST_SUITE_P(Scenes, EnvelopeOracle, ::testing::ValuesIn(kSceneRegimes), name_of);

class EnvelopeScripts : public ::testing::TestWithParam<Regime> {};

// Extreme coordinates among others: infinities, denormals, the ends of the integers.
template <class Scalar, int Dim>
std::string play_script(const Regime& regime, std::size_t turn) {
  // Coordinates are nothing to the thread sanitizer, and scenes are played to it as well.
  const std::size_t stride = (kThreadSanitized ? 9 : kSanitized ? 3 : 1) * (plays_all() ? 1 : 3);
  for (const Setting& setting : settings()) {
    ++turn;
    if ((turn + first_turn(regime.name)) % stride != 0) continue;
    Config config;
    config.cell.kind = kKinds[turn % kKinds.size()];
    config.cell_population = turn % 2 == 0 ? 2 : 20;
    config.threads = turn % 3 == 0 ? 3 : 1;
    config.parallel_from = 0;
    config.reduction = kReductions[turn / 2 % 2];
    const bool wide = setting.options.margin > 5 || setting.options.margin_steps > 0 || setting.options.swept;
    if (wide) config.reduction = Reduction::kSingleReporter;  // for there, wide boxes are in few cells
    config.envelope = setting.options;
    const std::string wrong = play_envelopes<Scalar, Dim>(config, CellScript<Scalar, Dim>(regime, turn), regime.drains,
                                                          kCalls[turn % kCalls.size()]);
    if (!wrong.empty()) return std::string(setting.name) + ", seed " + std::to_string(turn) + ": " + wrong;
  }
  return {};
}

std::string script_name_of(const ::testing::TestParamInfo<Regime>& info) { return info.param.name; }

TEST_P(EnvelopeScripts, MissNothingInFloat) { EXPECT_EQ((play_script<float, 2>(GetParam(), 0)), ""); }
TEST_P(EnvelopeScripts, MissNothingInDouble) { EXPECT_EQ((play_script<double, 3>(GetParam(), 1)), ""); }
TEST_P(EnvelopeScripts, MissNothingInInt) { EXPECT_EQ((play_script<std::int32_t, 3>(GetParam(), 2)), ""); }
TEST_P(EnvelopeScripts, MissNothingInShort) { EXPECT_EQ((play_script<std::int16_t, 2>(GetParam(), 3)), ""); }
INSTANTIATE_TEST_SUITE_P(Scripts, EnvelopeScripts, ::testing::ValuesIn(kRegimes), script_name_of);

// Enough objects that scans, the filter and the lists of candidates are cut into several tasks.
TEST(EnvelopeThreads, LeaveNoTrace) {
  const SceneRegime regime{.name = "Many",
                           .travel = Travel::kJitter,
                           .population = kSanitized    ? 2500
                                         : plays_all() ? 9000
                                                       : 5000,
                           .moving_percent = 50,
                           .churn_percent = 3,
                           .steps = 4};
  for (const Setting& setting : settings()) {
    if (setting.options.margin > 10) continue;  // too many pairs
    std::vector<Events<std::uint64_t>> expected;
    for (const int threads : {1, 2, 8}) {
      for (const CellKind kind : {CellKind::kRows, CellKind::kSegmented}) {
        if (kind == CellKind::kSegmented && threads != 2) continue;
        if (kind == CellKind::kRows && threads == 2 && !plays_all()) continue;
        Config config;
        config.threads = threads;
        config.parallel_from = 0;
        config.cell.kind = kind;
        config.envelope = setting.options;
        Engine<float, 2> engine(config);
        SceneScript<float, 2> script(regime, 1);
        std::vector<Events<std::uint64_t>> stream;
        for (int step = 0; step < regime.steps; ++step) {
          queue(engine, script.next(), threads == 8 ? Calls::kFourThreads : Calls::kBulk);
          stream.push_back(engine.step());
        }
        ASSERT_NO_THROW(engine.validate());
        if (expected.empty()) expected = stream;
        ASSERT_EQ(expected, stream) << setting.name << ", " << threads << " threads";
      }
    }
  }
}

}  // namespace
}  // namespace sweepgrid::oracle::envelope_oracle_test
