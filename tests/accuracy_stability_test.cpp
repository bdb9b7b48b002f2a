// The stability map: what is measured is what the report shows.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "accuracy/methods.hpp"
#include "accuracy/regimes.hpp"
#include "sanitized.hpp"
#include "study/stability/stability_study.hpp"

namespace sweepgrid::study::accuracy_stability_test {
namespace {

using accuracy::Trial;
using accuracy::Verdict;

Trial exact_trial(double step_ms) {
  Trial trial;
  trial.steps = 10;
  trial.step_ms = step_ms;
  return trial;
}

/// Every method exact and as fast as in the calm scene.
StabilityResults calm_results() {
  StabilityResults results;
  for (const accuracy::Method& method : accuracy::methods()) {
    results.calm[method.name] = exact_trial(2);
    for (const accuracy::Regime& regime : stability_regimes()) {
      for (const std::string& value : regime.values) {
        results.hard[regime.id + "=" + value][method.name] = exact_trial(2);
      }
    }
  }
  return results;
}

const std::vector<Cell>& row_of(const Report& report, const std::string& method) {
  const auto& rows = report.sections.at(0).tables.at(0).rows;
  return *std::find_if(rows.begin(), rows.end(), [&](const auto& row) { return row[0].text == method; });
}

const HeatMap& map_of(const Report& report, const std::string& regime) {
  const auto& maps = report.sections.at(1).maps;
  return *std::find_if(maps.begin(), maps.end(), [&](const HeatMap& map) { return map.id == "regime-" + regime; });
}

const Tile& tile_of(const HeatMap& map, const std::string& method, const std::string& value) {
  return *std::find_if(map.tiles.begin(), map.tiles.end(), [&](const Tile& tile) {
    return map.rows[tile.row] == method && map.columns[tile.column] == value;
  });
}

TEST(StabilityReport, HasAMapForEveryRegimeAndATileForEveryTrial) {
  const Report report = stability_report({}, calm_results(), false);
  ASSERT_EQ(report.sections.at(1).maps.size(), stability_regimes().size());
  for (const HeatMap& map : report.sections[1].maps) {
    EXPECT_EQ(map.tiles.size(), map.rows.size() * map.columns.size());
    for (const Tile& tile : map.tiles) {
      EXPECT_EQ(tile.value, 1);
      EXPECT_EQ(tile.mark, "=");
    }
  }
  for (const auto& row : report.sections[0].tables.at(0).rows) {
    EXPECT_EQ(row[7].text, "nowhere");
    EXPECT_EQ(row[8].text, "nowhere");
  }
}

TEST(StabilityReport, NamesTheWorstCostAndTheFirstOfEachFailure) {
  StabilityResults results = calm_results();
  results.hard["speed=100"]["octree"] = exact_trial(60);
  for (const std::string value : {"1e7", "1e8"}) {
    Trial& trial = results.hard["far=" + value]["octree"];
    trial.verdict = Verdict::kMisses;
    trial.true_pairs = 10;
    trial.missed_pairs = 3;
  }
  Trial& lost = results.hard["point=0"]["octree"];
  lost = Trial();
  lost.verdict = Verdict::kOutOfMemory;
  const Report report = stability_report({}, results, false);
  const std::vector<Cell>& row = row_of(report, "octree");
  EXPECT_EQ(row[3].number, 30);
  EXPECT_EQ(row[4].text, "speed=100");
  EXPECT_EQ(row[7].text, "speed (30)");
  EXPECT_EQ(row[8].text, "misses from far=1e7; memory from point=0");
  EXPECT_EQ(row_of(report, "engine")[8].text, "nowhere");
  const Tile& missing = tile_of(map_of(report, "far"), "octree", "1e8");
  EXPECT_EQ(missing.mark, "miss");
  EXPECT_NE(missing.label.find("3 of 10 pairs missed"), std::string::npos);
  const Tile& out = tile_of(map_of(report, "point"), "octree", "0");
  EXPECT_EQ(out.mark, "mem");
  EXPECT_FALSE(out.value.has_value());
}

TEST(StabilityReport, CrowdsStandApart) {
  StabilityResults results = calm_results();
  Trial crowd = exact_trial(80);
  crowd.true_pairs = crowd.steps * 2000 * 2000 / 4;
  results.hard["point=0"]["octree"] = crowd;
  results.hard["speed=100"]["octree"] = exact_trial(20);
  const Report report = stability_report({}, results, false);
  const std::vector<Cell>& row = row_of(report, "octree");
  EXPECT_EQ(row[3].number, 40);
  EXPECT_EQ(row[4].text, "point=0");
  EXPECT_EQ(row[5].number, 10);
  EXPECT_EQ(row[6].text, "speed=100");
}

TEST(StabilityReport, ShowsGrowthRelativeToAsManyCalmObjects) {
  StabilityResults results = calm_results();
  for (const std::uint64_t objects : {100, 200}) {
    for (const accuracy::Method& method : growing_methods()) {
      auto& trials = results.growing[objects];
      trials[calm_name()][method.name] = exact_trial(static_cast<double>(objects));
      for (const accuracy::Regime& regime : growing_regimes()) {
        Trial& trial = trials[point_name(regime, regime.values.back())][method.name];
        if (objects == 100) trial = exact_trial(700);
      }
    }
  }
  const Report report = stability_report({}, results, false);
  const std::vector<LineChart>& charts = report.sections.at(2).charts;
  ASSERT_EQ(charts.size(), growing_regimes().size());
  for (const Series& series : charts[0].series) {
    ASSERT_EQ(series.points.size(), 1U) << series.name;  // nothing is shown where nothing was measured
    EXPECT_EQ(series.points[0].x, 100);
    EXPECT_EQ(series.points[0].y, 7);
  }
}

TEST(StabilityReport, ASupersetIsNoFailureOfWhoClaimsNoMore) {
  if (!accuracy::find_method("bullet/axis16")) GTEST_SKIP() << "built without Bullet (Debian: libbullet-dev)";
  StabilityResults results = calm_results();
  for (const std::string method : {"bullet/axis16", "bullet/dbvt"}) {
    results.hard["far=1e8"][method].verdict = Verdict::kSuperset;
  }
  const Report report = stability_report({}, results, false);
  EXPECT_EQ(row_of(report, "bullet/axis16")[8].text, "nowhere");
  EXPECT_EQ(row_of(report, "bullet/dbvt")[8].text, "superset from far=1e8");
}

TEST(StabilityStudy, WritesAReportOfTrialsThatWereMade) {
  if (oracle::kSanitized) GTEST_SKIP() << "guarded runs are not for sanitizers";
  StudyOptions options;
  options.out = testing::TempDir() + "stability_study";
  options.points = Points::kFresh;
  EXPECT_TRUE(stability_study(options, {30, 2, {std::uint64_t{1} << 29, 10}, {20, 40}, 2}));
  std::ifstream file(std::filesystem::path(options.out) / "study-stability.json");
  const nlohmann::json json = nlohmann::json::parse(file);
  EXPECT_EQ(json.at("study"), "stability");
  EXPECT_EQ(json.at("sections").size(), 3U);
  EXPECT_EQ(json.at("sections")[2].at("charts")[0].at("series")[0].at("points").size(), 2U);
  std::filesystem::remove_all(options.out);
}

TEST(TrialJson, ComesBackAsItWas) {
  Trial trial = exact_trial(0.1);
  trial.verdict = Verdict::kTakesBad;
  trial.error = "\"reason\"";
  trial.reported_pairs = 7;
  trial.extra_pairs = 3;
  trial.refused_boxes = 2;
  trial.start_ms = 1.5;
  trial.most_step_ms = 9;
  trial.peak_bytes = std::uint64_t{1} << 40;
  const nlohmann::json json = accuracy::trial_json(trial);
  EXPECT_EQ(accuracy::trial_json(accuracy::trial_of(json)), json);
  EXPECT_EQ(json.at("verdict"), "bad");
  nlohmann::json unknown = json;
  unknown["verdict"] = "fine";
  EXPECT_THROW((void)accuracy::trial_of(unknown), std::invalid_argument);
}

}  // namespace
}  // namespace sweepgrid::study::accuracy_stability_test
