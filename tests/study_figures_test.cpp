// The study of the paper's figures: its systems are exact and are found out where they are not, claims are judged by
// what was measured, and the program writes a whole report however often it is stopped.
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "scenes_data/scene_files.hpp"
#include "study/figures/claim.hpp"
#include "study/figures/figure_plans.hpp"
#include "study/figures/figure_sections.hpp"
#include "study/figures/figures_study.hpp"
#include "study/figures/paper_claims.hpp"
#include "study/figures/results.hpp"

namespace sweepgrid::study::study_figures_test {
namespace {

using nlohmann::json;

json read_json(const std::string& path) {
  std::ifstream file(path);
  return json::parse(file);
}

Claim claim_within(std::optional<double> value, Band band) {
  return {.where = "4",
          .says = "something",
          .what = "ratio",
          .value = value,
          .band = band,
          .why_less = "too little",
          .why_more = "too much"};
}

TEST(Claims, AreJudgedByTheMeasuredValueAlone) {
  const Band band{1.5, 2};
  EXPECT_EQ(judge(claim_within(1.5, band)), Verdict::kAgrees);
  EXPECT_EQ(judge(claim_within(2, band)), Verdict::kAgrees);
  EXPECT_EQ(judge(claim_within(1.49, band)), Verdict::kDiffers);
  EXPECT_EQ(judge(claim_within(2.01, band)), Verdict::kDiffers);
  EXPECT_EQ(judge(claim_within(std::numeric_limits<double>::quiet_NaN(), band)), Verdict::kDiffers);
  EXPECT_EQ(judge(claim_within(std::nullopt, band)), Verdict::kNotMeasured);
  EXPECT_EQ(judge(claim_within(1e9, {.low = 1})), Verdict::kAgrees);
}

TEST(Claims, TellTheReasonOfTheSideOnWhichTheyDiffer) {
  const Band band{1.5, 2};
  EXPECT_EQ(reason(claim_within(1.7, band)), "");
  EXPECT_EQ(reason(claim_within(1, band)), "too little");
  EXPECT_EQ(reason(claim_within(3, band)), "too much");
  EXPECT_EQ(reason(claim_within(std::nullopt, band)), "");
  Claim foreign = claim_within(1.7, band);
  foreign.beyond_us = "another program";
  EXPECT_EQ(judge(foreign), Verdict::kNotComparable);
  EXPECT_EQ(reason(foreign), "another program");
}

Contest made_up(double x, std::vector<double> first, std::vector<double> second) {
  Contest contest;
  contest.scene = "made up";
  contest.entries = {{"first", x, std::move(first), {}, 1, ""}, {"second", x, std::move(second), {}, 1, ""}};
  return contest;
}

TEST(Results, CompareRoundByRound) {
  Results results;
  results.add("8", made_up(10, {2, 40, 6}, {1, 10, 3}));
  const auto ratio = results.times_faster("8", 10, "first", "second");
  ASSERT_TRUE(ratio);
  EXPECT_EQ(ratio->median, 2);
  EXPECT_EQ(ratio->high, 4);
  EXPECT_FALSE(results.times_faster("8", 11, "first", "second"));
  EXPECT_FALSE(results.times_faster("9", 10, "first", "second"));
}

TEST(Results, FindWhereOneOvertakesTheOther) {
  Results crossing;
  EXPECT_FALSE(crossing.crossing("9", "first", "second"));
  crossing.add("9", made_up(10, {1}, {4}));
  crossing.add("9", made_up(20, {2}, {4}));
  EXPECT_EQ(crossing.crossing("9", "first", "second"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(crossing.crossing("9", "second", "first"), 0);
  crossing.add("9", made_up(40, {8}, {4}));
  EXPECT_NEAR(*crossing.crossing("9", "first", "second"), 30, 1e-9);
}

// A figure's systems over a scene in which objects move, come and go.
Contest play_small(const std::string& scene, const std::string& figure) {
  for (const FigurePoint& point : figure_points(true, {figure})) {
    ContestPlan plan = point.plan;
    plan.scene = scene;
    plan.rounds = 2;
    plan.steps_per_round = 2;
    return play(plan);
  }
  return {};
}

TEST(Contests, AllSystemsAreExact) {
  for (const char* const figure : {figure::k9, figure::k11, figure::kSorts, figure::kReplaced}) {
    const Contest contest = play_small("uniform:n=500,moving=0.6,churn=0.02,density=0.3", figure);
    EXPECT_GT(contest.pairs, 100U);
    for (const Entry& entry : contest.entries) {
      EXPECT_EQ(entry.complaint, "") << entry.system;
      EXPECT_EQ(entry.seconds.size(), 2U);
      EXPECT_EQ(entry.steps, 4U);
    }
  }
}

TEST(Contests, SurviveTheWayThroughAFile) {
  const Contest contest = play_small("uniform:n=200,moving=1,churn=0.01,density=0.3", figure::k11);
  const json text = to_json(contest);
  EXPECT_EQ(to_json(contest_of(json::parse(text.dump()))), text);
}

TEST(Contests, WrongPairsAreToldWhereverSpeedIs) {
  Results results;
  results.add("8", made_up(10, {1}, {1}));
  EXPECT_TRUE(all_exact(results));
  Contest wrong = made_up(20, {1}, {1});
  wrong.entries[1].complaint = "3 pairs are missing";
  results.add("8", wrong);
  EXPECT_FALSE(all_exact(results));
  EXPECT_NE(exactness_section(results).text.find("WRONG"), std::string::npos);
  const std::vector<Section> sections = figure_sections(results);
  const Point& point = sections[0].charts[0].series[1].points[1];
  EXPECT_NE(point.label.find("3 pairs are missing"), std::string::npos);
}

// All points of the study, with few objects and few steps: what they show is nonsense, but everything is there.
std::vector<FigurePoint> tiny_points() {
  std::vector<FigurePoint> points = figure_points(true, {});
  for (FigurePoint& point : points) {
    point.plan.scene = std::regex_replace(point.plan.scene, std::regex(":n=[0-9e+]+"), ":n=100");
    // Ten of ten thousands are none of a hundred.
    if (point.figure == figure::kInsertWork) {
      point.plan.scene = std::regex_replace(point.plan.scene, std::regex("churn=[^,]+"), "churn=0.1");
    }
    point.plan.rounds = 2;
    point.plan.steps_per_round = 1;
  }
  return points;
}

TEST(FiguresStudy, ReportsEveryFigureAndEveryClaim) {
  const scene_files::Directory directory;
  const FiguresOptions options{.study = {.out = directory.path("")}};
  ASSERT_TRUE(figures_study(options, tiny_points()));
  const json report = read_json(directory.path("study-figures.json"));
  const std::string text = report.dump();
  for (const char* id : {"figure-2", "figure-8", "figure-9", "figure-10", "figure-11", "claims", "exactness",
                         "exponents", "population", "segments", "coherence"}) {
    EXPECT_NE(text.find(std::string("\"") + id + "\""), std::string::npos) << id;
  }
  // A second run takes all points from the file.
  const auto written = std::filesystem::file_size(directory.path("study-figures.points.jsonl"));
  ASSERT_TRUE(figures_study(options, tiny_points()));
  EXPECT_EQ(std::filesystem::file_size(directory.path("study-figures.points.jsonl")), written);
}

TEST(FiguresStudy, MeasuresSomethingForEveryClaim) {
  Results results;
  for (const FigurePoint& point : tiny_points()) results.add(point.figure, play(point.plan));
  const std::vector<Claim> claims = paper_claims(results);
  EXPECT_GT(claims.size(), 40U);
  for (const Claim& claim : claims) {
    EXPECT_NE(judge(claim), Verdict::kNotMeasured) << claim.where << ": " << claim.says;
    EXPECT_EQ(judge(claim) == Verdict::kAgrees, reason(claim).empty()) << claim.where << ": " << claim.says;
  }
}

TEST(FiguresStudy, WithoutAFigureItsClaimsAreNotMeasured) {
  for (const Claim& claim : paper_claims(Results())) {
    const Verdict verdict = judge(claim);
    EXPECT_TRUE(verdict == Verdict::kNotMeasured || verdict == Verdict::kNotComparable) << claim.says;
  }
}

/// Runs the program.
class Study : public testing::Test {
 protected:
  int run(const std::string& arguments, const std::string& before = "") const {
    const std::string command = before + " '" + SWEEPGRID_PROGRAM + "' study figures " + arguments + " >'" +
                                directory_.path("stdout") + "' 2>'" + directory_.path("stderr") + "'";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  [[nodiscard]] std::string said() const {
    std::ifstream file(directory_.path("stderr"));
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  [[nodiscard]] std::vector<std::string> point_lines() const {
    std::ifstream file(directory_.path("study-figures.points.jsonl"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    return lines;
  }
  [[nodiscard]] std::string out() const { return "--out '" + directory_.path("") + "'"; }
  /// What to put before the program, for a signal to reach it once a point is finished: never before it listens.
  [[nodiscard]] std::string after_first_point(const std::string& signal) const {
    return "sh -c '\"$@\" & program=$!; while kill -0 $program 2>/dev/null && ! grep -qs .point.: \"$0\"; do sleep "
           "0.02; "
           "done; " +
           ("kill -" + signal + " $program; wait $program' '") + directory_.path("study-figures.points.jsonl") + "'";
  }

  scene_files::Directory directory_;
};

// The whole figure takes half a minute, its first point under a second: a signal after that is never too late.
TEST_F(Study, IsStoppedBySignalsAndKeepsItsPoints) {
  const std::string arguments = "--figure 8 " + out();
  EXPECT_EQ(run(arguments, after_first_point("TERM")), 128 + SIGTERM) << said();
  EXPECT_NE(said().find("the same command goes on"), std::string::npos) << said();
  const std::vector<std::string> lines = point_lines();
  EXPECT_EQ(run(arguments, after_first_point("KILL")), 128 + SIGKILL) << said();
  const std::vector<std::string> more = point_lines();
  ASSERT_GE(more.size(), lines.size());
  EXPECT_TRUE(std::equal(lines.begin(), lines.end(), more.begin()));
}

TEST_F(Study, ComesToItsEndWhereverItWasStopped) {
  const std::string arguments = "--quick --figure 8 " + out();
  EXPECT_EQ(run(arguments), 0) << said();
  const std::vector<std::string> whole = point_lines();
  ASSERT_GT(whole.size(), 5U);
  {  // Killed while it wrote the fifth line.
    std::ofstream file(directory_.path("study-figures.points.jsonl"), std::ios::trunc);
    for (std::size_t i = 0; i < 4; ++i) file << whole[i] << '\n';
    file << whole[4].substr(0, whole[4].size() / 2);
  }
  EXPECT_EQ(run(arguments), 0) << said();
  EXPECT_NE(said().find("finished points are taken"), std::string::npos) << said();
  const std::vector<std::string> lines = point_lines();
  ASSERT_GE(lines.size(), 4U);
  EXPECT_TRUE(std::equal(lines.begin(), lines.begin() + 4, whole.begin())) << "measured again";
  std::set<std::string> points;
  for (const std::string& line : lines) {
    const json parsed = json::parse(line);
    if (!parsed.contains("point")) continue;
    EXPECT_TRUE(points.insert(parsed["point"]).second) << "measured twice: " << line;
  }
  EXPECT_EQ(points.size(), figure_points(true, {"8"}).size());
  EXPECT_NE(read_json(directory_.path("study-figures.json")).dump().find("figure-8"), std::string::npos);
  EXPECT_EQ(run("--resume " + arguments), 0) << said();
}

TEST_F(Study, NamesWhatIsWrong) {
  const std::pair<std::string, std::string> cases[] = {
      {"--figure 7", "--figure"},
      {"--figure 7", "7"},
      {"--quick --out /proc/nowhere", "/proc/nowhere"},
      {"--resume --fresh", "--fresh"},
      {"--quick --resume --figure 8 " + out(), "no points of this study to resume"}};
  for (const auto& [arguments, expected] : cases) {
    EXPECT_EQ(run(arguments), 2) << arguments;
    EXPECT_NE(said().find(expected), std::string::npos) << arguments << ": " << said();
  }
}

}  // namespace
}  // namespace sweepgrid::study::study_figures_test
