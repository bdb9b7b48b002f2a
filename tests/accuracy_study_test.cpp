// The speed-accuracy charts: small scenes from end to end, and promises that are not kept.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "scenes/scene_error.hpp"
#include "study/accuracy/accuracy_study.hpp"
#include "study/accuracy/best_points.hpp"

namespace sweepgrid::study::accuracy_study_test {
namespace {

using accuracy::TruthKind;
using Json = nlohmann::json;

constexpr const char* kFast = "fast:n=200,steps=8,density=0.3";
constexpr const char* kTurning = "turning:n=100,steps=8";
const AccuracySize kTiny{100, 4, 8, 2, 100000};

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

const ConfigurationResult& of_name(const SceneResult& result, const std::string& name) {
  return *std::find_if(result.configurations.begin(), result.configurations.end(),
                       [&](const ConfigurationResult& one) { return one.name == name; });
}

Json chart_of(const Json& section, const std::string& id) {
  for (const Json& chart : section.at("charts")) {
    if (chart.at("id") == id) return chart;
  }
  return {};
}

class AccuracyStudy : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    options_.study.out = folder_;
    options_.scenes = {kFast, kTurning};
    options_.narrow_cost = 100;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] Json report() const { return Json::parse(text_of(folder_ / "study-accuracy.json")); }

  std::filesystem::path folder_;
  AccuracyOptions options_;
};

TEST_F(AccuracyStudy, WritesAPanelForEveryTruthAndKindOfError) {
  ASSERT_TRUE(accuracy_study(options_, kTiny));
  const Json sections = report().at("sections");
  ASSERT_EQ(sections.size(), 3U);
  EXPECT_EQ(sections[0].at("tables").size(), 1U);
  EXPECT_EQ(sections[0].at("tables")[0].at("rows").size(), 5U);  // T0, T1; T0, T1, T2
  EXPECT_EQ(sections[1].at("charts").size(), 2 * 3 + 1U);
  EXPECT_EQ(sections[2].at("charts").size(), 3 * 3 + 1U);
  for (const std::string id : {"t0-missed", "t0-extra", "t1-missed", "t1-extra", "t2-missed", "t2-extra"}) {
    const Json chart = chart_of(sections[2], "scene-1-" + id);
    ASSERT_TRUE(chart.is_object()) << id;
    EXPECT_FALSE(chart.at("x").at("log")) << "a zero would be left out";
    std::size_t points = 0;
    for (const Json& series : chart.at("series")) {
      for (const Json& point : series.at("points")) EXPECT_FALSE(point.at("label").get<std::string>().empty());
      if (series.at("style") == "scatter") points += series.at("points").size();
    }
    EXPECT_EQ(points, configurations().size()) << id;
    EXPECT_EQ(chart.at("series").back().at("style"), "front");
  }
  // The second time nothing is measured again, whatever the price.
  options_.study.points = Points::kResume;
  const Json before = chart_of(sections[1], "scene-0-t0-missed");
  options_.narrow_cost = 1e6;
  ASSERT_TRUE(accuracy_study(options_, kTiny));
  EXPECT_EQ(chart_of(report().at("sections")[1], "scene-0-t0-missed"), before);
  EXPECT_NE(report().at("sections")[1].at("tables"), sections[1].at("tables"));
}

TEST_F(AccuracyStudy, SaysWhatDidNotKeepItsPromise) {
  options_.scenes = {kFast};
  ASSERT_TRUE(accuracy_study(options_, kTiny));
  const std::filesystem::path path = folder_ / "study-accuracy.points.jsonl";
  std::string points = text_of(path);
  const std::string none = "\"missed_pairs\":0";  // the first is that of the first configuration
  ASSERT_NE(points.find(none), std::string::npos);
  points.replace(points.find(none), none.size(), "\"missed_pairs\":3");
  std::ofstream(path) << points;
  options_.study.points = Points::kResume;
  EXPECT_FALSE(accuracy_study(options_, kTiny));
  const Json table = report().at("sections")[0].at("tables").at(1);
  EXPECT_EQ(table.at("id"), "broken-promises");
  const std::string sentence = table.at("rows").at(0).at(0).at("text");
  EXPECT_NE(sentence.find(kFast), std::string::npos);
  EXPECT_NE(sentence.find("\"double\" promises exactly the pairs of T0, but missed 3"), std::string::npos) << sentence;
}

TEST_F(AccuracyStudy, NamesWhatItCannotTake) {
  const auto message = [&] {
    try {
      static_cast<void>(accuracy_study(options_, kTiny));
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  options_.scenes = {kFast, "uniform:speeed=1"};
  EXPECT_NE(message().find("speeed"), std::string::npos) << message();
  EXPECT_FALSE(std::filesystem::exists(folder_)) << "told before anything is measured";
  options_.scenes = {kFast, kFast};
  EXPECT_NE(message().find(kFast), std::string::npos) << message();
  options_.scenes = {"bad:n=100,nan=0.5,steps=3"};
  EXPECT_NE(message().find("bad:n=100,nan=0.5,steps=3: step 1: the box of object"), std::string::npos) << message();
  options_.scenes = {"huge:n=100,infinite=0.5,steps=3"};
  EXPECT_NE(message().find("step 0: the box of object"), std::string::npos) << message();
  options_.scenes = {"uniform:n=10,steps=0"};
  EXPECT_NE(message().find("no step"), std::string::npos) << message();
  options_.scenes = {kFast};
  options_.narrow_cost = -1;
  EXPECT_NE(message().find("-1"), std::string::npos) << message();
}

TEST_F(AccuracyStudy, GivesUpWhatReportsTooMuch) {
  AccuracySize size = kTiny;
  size.most_pairs = 300;
  options_.scenes = {kFast};
  ASSERT_TRUE(accuracy_study(options_, size));
  std::size_t given_up = 0;
  const Json table = report().at("sections")[1].at("tables")[0];
  for (const Json& row : table.at("rows")) {
    if (row[1].at("text").get<std::string>().starts_with("given up: ")) ++given_up;
  }
  EXPECT_GT(given_up, 0U);
  EXPECT_LT(given_up, configurations().size());
}

TEST(MeasureScene, FindsWhatEverySettingGuarantees) {
  const SceneResult result = measure_scene(know_scene(kFast, 8), kTiny);
  ASSERT_EQ(result.configurations.size(), configurations().size());
  EXPECT_TRUE(broken_promises(result).empty());
  std::size_t exact = 0;
  for (const ConfigurationResult& one : result.configurations) {
    ASSERT_EQ(one.given_up, "");
    EXPECT_EQ(one.step_ms.size(), 2U);
    ASSERT_EQ(one.accuracies.size(), 2U);
    EXPECT_GT(one.accuracies[0].true_pairs, 0U);
    EXPECT_GT(one.accuracies[1].true_pairs, one.accuracies[0].true_pairs);
    if (guarantee(find_configuration(one.name), TruthKind::kInstants, one.violations) == Guarantee::kExact) {
      ++exact;
      EXPECT_TRUE(one.accuracies[0].exact()) << one.name;
    }
  }
  EXPECT_EQ(exact, 5U);
  EXPECT_EQ(of_name(result, "swept").accuracies[1].missed_pairs, 0U);
  EXPECT_GT(of_name(result, "double").accuracies[1].missed_pairs, 0U) << "objects tunnel";
  for (const std::string stride : {"stride 2", "stride 4", "stride 8"}) {
    EXPECT_GT(of_name(result, stride).accuracies[0].missed_pairs, 0U) << stride;
    EXPECT_GT(of_name(result, stride).violations, 0U) << stride;
  }
  const Json json = scene_result_json(result);
  EXPECT_EQ(scene_result_json(scene_result_of(json)), json);
}

TEST(MeasureScene, RoundsOutwardFarFromTheOrigin) {
  const SceneResult result = measure_scene(know_scene("far:n=100,steps=4,offset=1e8", 4), kTiny);
  EXPECT_TRUE(broken_promises(result).empty());
  EXPECT_TRUE(of_name(result, "double").accuracies[0].exact());
  EXPECT_EQ(of_name(result, "float, outward").accuracies[0].missed_pairs, 0U);
  EXPECT_GT(of_name(result, "float, outward").accuracies[0].extra_pairs, 0U);
}

TEST(BrokenPromises, AreOfThoseWhoPromised) {
  SceneResult result{"scene", 10, 2, 1, {TruthKind::kInstants, TruthKind::kMotion}, {}};
  const auto add = [&](const std::string& name, std::uint64_t violations) -> accuracy::Accuracy& {
    ConfigurationResult& one = result.configurations.emplace_back();
    one.name = name;
    one.violations = violations;
    one.accuracies.resize(2);
    return one.accuracies[1];
  };
  add("double", 0).missed_pairs = 1;
  add("stride 4", 1).missed_pairs = 1;
  add("swept", 0).extra_pairs = 5;
  EXPECT_TRUE(broken_promises(result).empty());
  add("16 bits, swept", 0).missed_pairs = 2;
  ASSERT_EQ(broken_promises(result).size(), 1U);
  EXPECT_EQ(broken_promises(result)[0],
            "scene: \"16 bits, swept\" promises a superset of T1, but missed 2 pairs and reported 0 that are none");
}

TEST(Guarantee, OfAStrideHoldsWhileNobodyIsOutside) {
  const Configuration& reports = find_configuration("stride 4, moving margin");
  EXPECT_EQ(guarantee(reports, TruthKind::kInstants, 0), Guarantee::kSuperset);
  EXPECT_EQ(guarantee(reports, TruthKind::kInstants, 1), Guarantee::kMayMiss);
  const Configuration& queries = find_configuration("stride 4, moving margin, queries, exact");
  EXPECT_EQ(guarantee(queries, TruthKind::kInstants, 1), Guarantee::kExact);
  EXPECT_EQ(guarantee(queries, TruthKind::kMotion, 0), Guarantee::kMayMiss);
  EXPECT_EQ(guarantee(queries, TruthKind::kShapes, 0), Guarantee::kSuperset);
  EXPECT_THROW(static_cast<void>(find_configuration("none")), std::invalid_argument);
}

TEST(ParetoFront, HoldsWhatNoOtherBeats) {
  const std::vector<Place> places = {{1, 5}, {0, 9}, {1, 4}, {2, 4}, {3, 1}, {0, 10}, {3, 1}};
  EXPECT_EQ(pareto_front(places), (std::vector<std::size_t>{1, 2, 4}));
  EXPECT_TRUE(pareto_front({}).empty());
}

TEST(CheapestComplete, ChargesForEveryPair) {
  std::vector<AccuracyPoint> points(3);
  points[0].step_ms.median = 3;
  points[0].candidates = 1000;
  points[1].step_ms.median = 2;
  points[1].candidates = 5000;
  points[2].step_ms.median = 1;
  points[2].accuracy.missed_pairs = 1;
  EXPECT_EQ(cheapest_complete(points, 0), 1U);
  EXPECT_EQ(cheapest_complete(points, 1000), 0U);
  EXPECT_DOUBLE_EQ(points[1].total_ms(1000).median, 7);
  points.erase(points.begin(), points.begin() + 2);
  EXPECT_EQ(cheapest_complete(points, 0), points.size());
}

}  // namespace
}  // namespace sweepgrid::study::accuracy_study_test
