// The arithmetic of missed and extra pairs, of late and early events, and of flicker.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "accuracy/accuracy_json.hpp"
#include "accuracy/accuracy_tally.hpp"

namespace sweepgrid::accuracy::accuracy_tally_test {
namespace {

using Delays = std::map<std::int64_t, std::uint64_t>;

const std::vector<ScenePair> kNone;
const std::vector<ScenePair> kOne = {{1, 2}};

/// One pair's presence, a character for each step: 'x' where it is there.
Accuracy tally_of(const std::string& truth, const std::string& reported, std::uint64_t flicker_steps = 5) {
  AccuracyTally tally(flicker_steps);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    tally.step(truth[i] == 'x' ? kOne : kNone, reported[i] == 'x' ? kOne : kNone);
  }
  return tally.result();
}

TEST(AccuracyTally, CountsMissedAndExtraPairsOfEveryStep) {
  AccuracyTally tally;
  tally.step({{1, 2}, {1, 3}, {4, 5}}, {{1, 2}, {2, 3}});
  tally.step({{1, 2}}, {{1, 2}, {1, 3}, {2, 3}});
  const Accuracy& result = tally.result();
  EXPECT_EQ(result.steps, 2U);
  EXPECT_EQ(result.true_pairs, 4U);
  EXPECT_EQ(result.reported_pairs, 5U);
  EXPECT_EQ(result.missed_pairs, 2U);
  EXPECT_EQ(result.extra_pairs, 3U);
  EXPECT_DOUBLE_EQ(result.recall(), 0.5);
  EXPECT_DOUBLE_EQ(result.precision(), 0.4);
  EXPECT_FALSE(result.exact());
}

TEST(AccuracyTally, WithoutPairsNothingIsMissedAndNothingIsExtra) {
  const Accuracy result = tally_of("...", "...");
  EXPECT_DOUBLE_EQ(result.recall(), 1);
  EXPECT_DOUBLE_EQ(result.precision(), 1);
  EXPECT_TRUE(result.exact());
  EXPECT_EQ(result.begins.mean(), 0);
  EXPECT_EQ(result.begins.most(), 0);
}

TEST(AccuracyTally, AnExactMethodIsOnTimeAndFlickersAsTheTruthDoes) {
  const Accuracy result = tally_of(".xx.x.xxxx.", ".xx.x.xxxx.");
  EXPECT_TRUE(result.exact());
  EXPECT_EQ(result.true_contacts, 3U);
  EXPECT_EQ(result.answered_contacts, 3U);
  EXPECT_EQ(result.begins.events, (Delays{{0, 3}}));
  EXPECT_EQ(result.ends.events, (Delays{{0, 3}}));
  EXPECT_EQ(result.true_flicker, 2U);
  EXPECT_EQ(result.reported_flicker, 2U);
}

TEST(AccuracyTally, TellsHowLateAndHowEarlyEventsAre) {
  EXPECT_EQ(tally_of("..xxxx..", "....xx..").begins.events, (Delays{{2, 1}}));
  EXPECT_EQ(tally_of("..xxxx..", ".xxxxx..").begins.events, (Delays{{-1, 1}}));
  EXPECT_EQ(tally_of("..xxxx..", "..xxxxx.").ends.events, (Delays{{1, 1}}));
  EXPECT_EQ(tally_of("..xxxx..", "..x.....").ends.events, (Delays{{-3, 1}}));
}

TEST(AccuracyTally, ContactsThatAreNotSeenOrNotThereHaveNoTime) {
  const Accuracy missed = tally_of(".xx....", "....xx.");
  EXPECT_EQ(missed.true_contacts, 1U);
  EXPECT_EQ(missed.reported_contacts, 1U);
  EXPECT_EQ(missed.answered_contacts, 0U);
  EXPECT_EQ(missed.begins.count(), 0U);
  EXPECT_EQ(missed.ends.count(), 0U);
  EXPECT_EQ(missed.missed_pairs, 2U);
  EXPECT_EQ(missed.extra_pairs, 2U);
}

TEST(AccuracyTally, AContactIsAnsweredOnce) {
  // What is reported flickers: the first of its stays answers, and its end is too early by 4.
  const Accuracy flickers = tally_of(".xxxxxx.", ".xx.x.x.");
  EXPECT_EQ(flickers.answered_contacts, 1U);
  EXPECT_EQ(flickers.begins.events, (Delays{{0, 1}}));
  EXPECT_EQ(flickers.ends.events, (Delays{{-4, 1}}));
  EXPECT_EQ(flickers.reported_flicker, 2U);
  EXPECT_EQ(flickers.true_flicker, 0U);
  // What is true flickers, and is bridged: its first end is too late by 5, the later stays have no answer.
  const Accuracy bridged = tally_of(".x.x.x...", ".xxxxxx..");
  EXPECT_EQ(bridged.true_contacts, 3U);
  EXPECT_EQ(bridged.answered_contacts, 1U);
  EXPECT_EQ(bridged.ends.events, (Delays{{5, 1}}));
  EXPECT_EQ(bridged.true_flicker, 2U);
  EXPECT_EQ(bridged.reported_flicker, 0U);
  // The second contact gets an answer of its own.
  const Accuracy second = tally_of(".xx..xx.", "..xx..x.");
  EXPECT_EQ(second.answered_contacts, 2U);
  EXPECT_EQ(second.begins.events, (Delays{{1, 2}}));
  EXPECT_EQ(second.ends.events, (Delays{{0, 1}, {1, 1}}));
}

TEST(AccuracyTally, ContactsThatLastHaveNoEndYet) {
  EXPECT_EQ(tally_of("xxxx", "xxx.").ends.count(), 0U);
  EXPECT_EQ(tally_of("xxx.", "xxxx").ends.count(), 0U);
}

TEST(AccuracyTally, FlickerIsABeginSoonAfterABegin) {
  EXPECT_EQ(tally_of("x...x", "x...x", 3).reported_flicker, 0U);
  EXPECT_EQ(tally_of("x...x", "x...x", 4).reported_flicker, 1U);
  // Long after, whatever is still remembered.
  EXPECT_EQ(tally_of("x" + std::string(50, '.') + "x", std::string(52, '.'), 5).true_flicker, 0U);
  EXPECT_EQ(tally_of("x" + std::string(50, '.') + "x", std::string(52, '.'), 51).true_flicker, 1U);
}

TEST(DelayCounts, MeanAndMostAreOfMagnitudes) {
  const DelayCounts delays{{{-4, 1}, {0, 5}, {2, 2}}};
  EXPECT_EQ(delays.count(), 8U);
  EXPECT_EQ(delays.off_time(), 3U);
  EXPECT_DOUBLE_EQ(delays.mean(), 1);
  EXPECT_EQ(delays.most(), -4);
  EXPECT_EQ((DelayCounts{{{-4, 1}, {4, 1}}}).most(), 4);
}

TEST(PairsOfEvents, AreWhatTheEventsLeadTo) {
  PairsOfEvents pairs;
  EXPECT_EQ(pairs.step({{}, {{1, 2}, {3, 4}}}), (std::vector<ScenePair>{{1, 2}, {3, 4}}));
  EXPECT_EQ(pairs.step({{{1, 2}}, {{2, 3}, {5, 6}}}), (std::vector<ScenePair>{{2, 3}, {3, 4}, {5, 6}}));
  // A key erased and inserted again ends and begins the same pair.
  EXPECT_EQ(pairs.step({{{3, 4}}, {{3, 4}}}), (std::vector<ScenePair>{{2, 3}, {3, 4}, {5, 6}}));
}

TEST(AccuracyJson, HoldsEveryNumber) {
  const nlohmann::ordered_json json = accuracy_json(tally_of("..xxxx..", "....xxx."));
  EXPECT_EQ(json.dump(),
            R"({"steps":8,"true_pairs":4,"reported_pairs":3,"missed_pairs":2,"extra_pairs":1,"recall":0.5,)"
            R"("precision":0.6666666666666666,"true_contacts":1,"reported_contacts":1,"answered_contacts":1,)"
            R"("begins":{"count":1,"off_time":1,"mean":2.0,"most":2,"events":[[2,1]]},)"
            R"("ends":{"count":1,"off_time":1,"mean":1.0,"most":1,"events":[[1,1]]},)"
            R"("true_flicker":0,"reported_flicker":0})");
}

}  // namespace
}  // namespace sweepgrid::accuracy::accuracy_tally_test
