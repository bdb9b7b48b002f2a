#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sweepgrid/scheduler/executor.hpp>

#include "scenes/scene_error.hpp"
#include "study/machine_costs.hpp"
#include "study/scaling/prediction.hpp"
#include "study/scaling/run.hpp"
#include "study/scaling/scaling_study.hpp"
#include "study/scaling/scene.hpp"
#include "study/scaling/what_if.hpp"
#include "study/trace_events.hpp"

namespace sweepgrid::study::scaling_study_test {
namespace {

using Json = nlohmann::json;

const std::string kScene = "uniform:n=6000,moving=0.5,churn=0.01,seed=3";
const std::string kRecording = std::string(SWEEPGRID_RECORDINGS) + "/bullet_freefall_assorted_1000_f100.aabbs.xz";

double work_of(const std::vector<WorkGraph>& steps) {
  double work = 0;
  for (const WorkGraph& step : steps) work += work_and_span(step).work;
  return work;
}

std::size_t tasks_of(const std::vector<WorkGraph>& steps) {
  std::size_t tasks = 0;
  for (const WorkGraph& step : steps) {
    for (const WorkStage& stage : step) tasks += stage.tasks.size();
  }
  return tasks;
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(ScalingScene, GrowsByItsNumberOfObjectsAlone) {
  EXPECT_EQ(grown_scene("uniform", 2), "uniform:n=200000");
  EXPECT_EQ(grown_scene("pile:moving=1,n=5e3,seed=2", 3), "pile:n=15000,moving=1,seed=2");
  EXPECT_THROW(static_cast<void>(grown_scene(kRecording, 2)), SceneError);
}

TEST(ScalingScene, NeedsAStepThatChangesSomething) {
  EXPECT_THROW(static_cast<void>(read_scaling_scene("uniform:n=10,moving=0,churn=0", 5)), SceneError);
  const SceneScript scene = read_scaling_scene(kScene, 3);
  EXPECT_EQ(scene.steps.size(), 4U);
  EXPECT_EQ(scene.steps[0].inserted.size(), 6000U);
  EXPECT_EQ(scene.objects, 6000U + 3 * 60);
}

TEST(ScalingRun, EventsAreThoseOfTheOracleOnAnyNumberOfThreads) {
  for (const std::string& name : {kScene, kRecording, std::string("clusters:n=2000,dim=2,moving=1")}) {
    const SceneScript scene = read_scaling_scene(name, 6);
    const ScalingCheck check = check_scaling(scene);
    EXPECT_TRUE(check.ok) << name << check.error;
    EXPECT_EQ(check.steps_checked, scene.steps.size());
    EXPECT_GT(check.pairs, 0U);
    for (const int threads : {1, 3}) {
      const ScalingRun run = run_scaling(scene, {}, make_executor(threads), nullptr);
      EXPECT_EQ(run.checksum, check.checksum) << name;
      EXPECT_EQ(run.steps.size(), scene.steps.size() - 1);
      EXPECT_TRUE(run.work.empty());
    }
  }
}

TEST(ScalingRun, RecordsTheWorkAsItIsCutForSoManyWorkers) {
  const SceneScript scene = read_scaling_scene("uniform:n=40000,moving=1,churn=0.01", 2);
  const std::vector<WorkGraph> alone = record_work(scene, {}, 1, 2);
  const std::vector<WorkGraph> many = record_work(scene, {}, 64, 2);
  ASSERT_EQ(alone.size(), 2U);
  EXPECT_GT(tasks_of(many), 10 * tasks_of(alone));
  // The same stages are there, and none is cut into fewer tasks, but for one that may become serial work.
  const auto tasks_by_stage = [](const WorkGraph& step) {
    std::map<std::string, std::size_t> counts;
    for (const WorkStage& stage : step) counts[stage.name] += stage.tasks.size();
    return counts;
  };
  for (std::size_t s = 0; s < alone.size(); ++s) {
    const auto cut = tasks_by_stage(many[s]);
    for (const auto& [name, count] : tasks_by_stage(alone[s])) {
      ASSERT_TRUE(cut.contains(name)) << name;
      EXPECT_GE(cut.at(name) + 1, count) << name;
    }
  }
  // Bulk calls come before the stages of the step, and are cut, too.
  const WorkGraph& step = many[0];
  const auto tasks = [&](const char* name) {
    std::size_t count = 0;
    for (const WorkStage& stage : step) count += stage.name == name ? stage.tasks.size() : 0;
    return count;
  };
  EXPECT_EQ(step.front().name, "erase");
  EXPECT_EQ(step.back().name, "finish");
  EXPECT_GT(tasks("update"), 1U);
  EXPECT_GT(tasks("sweep"), 64U);
  for (std::size_t s = 1; s < step.size(); ++s)
    EXPECT_EQ(step[s].after, std::vector<std::uint32_t>{static_cast<std::uint32_t>(s - 1)});

  std::vector<WorkGraph> least = many;
  EXPECT_THROW(keep_least(least, alone), std::runtime_error);
  std::vector<WorkGraph> faster = many;
  faster[1].back().serial = 0;
  keep_least(least, faster);
  EXPECT_EQ(least[1].back().serial, 0);
}

TEST(ScalingRun, RecordsEveryWorkersTasks) {
  const SceneScript scene = read_scaling_scene(kScene, 2);
  const auto recorder = std::make_shared<RecordingExecutor>(make_executor(2));
  const ScalingRun run = run_scaling(scene, {}, recorder, recorder.get());
  ASSERT_EQ(run.busy.size(), run.stages.size());
  EXPECT_EQ(run.busy[0].size(), 2U);
  EXPECT_FALSE(run.last_step.empty());
  for (const RanTask& task : run.last_step) {
    EXPECT_GE(task.start, 0);
    EXPECT_LT(task.worker, 2);
  }
}

TEST(ScalingPrediction, OfOneWorkerIsTheWorkAndSurvivesJson) {
  const SceneScript scene = read_scaling_scene(kScene, 2);
  const MachineCosts costs;
  const Prediction one = predict(record_work(scene, {}, 1, 1), 1, costs, {{"drain", 0.5}});
  for (const Forecast& forecast : kForecasts) EXPECT_NEAR(one.seconds(forecast.id), one.work, 1e-9);
  double work = 0;
  for (const StageForecast& stage : one.stages) work += stage.work + stage.serial;
  EXPECT_NEAR(work, one.work, 1e-9);
  EXPECT_EQ(Json(Json(one).get<Prediction>()), Json(one));
}

TEST(ScalingWhatIf, OtherCutsAreTheSameWork) {
  const SceneScript scene = read_scaling_scene("uniform:n=20000,moving=1,churn=0", 1);
  std::size_t tasks_before = ~std::size_t{0};
  double work = 0;
  for (const CutVariant& variant : cut_variants(scene, 8, 1)) {
    if (variant.what != "grain") continue;
    EXPECT_LT(tasks_of(variant.steps), tasks_before) << variant.factor;
    tasks_before = tasks_of(variant.steps);
    if (variant.factor == 1) work = work_of(variant.steps);
    if (variant.factor > 1) {
      EXPECT_NEAR(work_of(variant.steps), work, 1e-9);
    }
  }
  EXPECT_GT(work, 0);
}

TEST(MachineCosts, SurviveJsonAndChargeForMemoryOnlyWhenAsked) {
  MachineCosts costs;
  costs.threads = 2;
  costs.spawn = {3e-8, 2e-8, 4e-8};
  costs.roof = {1.5, 1.25, 1.75};
  EXPECT_EQ(Json(Json(costs).get<MachineCosts>()), Json(costs));
  EXPECT_EQ(costs.schedule_costs(true).memory_roof, 1.5);
  EXPECT_TRUE(std::isinf(costs.schedule_costs(false).memory_roof));
  EXPECT_EQ(costs.schedule_costs(true).spawn, 3e-8);
  costs.roof = {};  // not measured
  EXPECT_TRUE(std::isinf(costs.schedule_costs(true).memory_roof));
}

TEST(TraceEvents, AreWhatViewersExpect) {
  const Json found = Json::parse(trace_events({{"run \"1\"", {"a", "b"}, {{1, "drain", "measured", 1e-6, 2.5e-6}}}}));
  const Json& events = found.at("traceEvents");
  ASSERT_EQ(events.size(), 4U);
  EXPECT_EQ(events[0], Json::parse(R"({"ph":"M","name":"process_name","pid":0,"tid":0,"args":{"name":"run \"1\""}})"));
  EXPECT_EQ(events[2], Json::parse(R"({"ph":"M","name":"thread_name","pid":0,"tid":1,"args":{"name":"b"}})"));
  EXPECT_EQ(events[3].at("ph"), "X");
  EXPECT_EQ(events[3].at("tid"), 1);
  EXPECT_DOUBLE_EQ(events[3].at("ts"), 1);
  EXPECT_DOUBLE_EQ(events[3].at("dur"), 2.5);
}

class ScalingStudy : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    options_.study.quick = true;
    options_.study.out = folder_;
    options_.scenes = {kScene};
    options_.threads = {1};
    options_.simulate = {4};
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
  ScalingOptions options_;
};

TEST_F(ScalingStudy, WritesReportAndTrace) {
  options_.weak = true;
  options_.trace = folder_ / "trace.json";
  ASSERT_TRUE(scaling_study(options_));
  const Json report = Json::parse(text_of(folder_ / "study-scaling.json"));
  EXPECT_EQ(report.at("study"), "scaling");
  ASSERT_EQ(report.at("sections").size(), 2U);
  const Json& scene = report.at("sections")[1];
  EXPECT_EQ(scene.at("title"), kScene);
  EXPECT_EQ(scene.at("charts").size(), 6U);
  EXPECT_EQ(scene.at("timelines").size(), 1U);
  // All that was not measured says so.
  for (const Json& series : scene.at("charts")[0].at("series")) {
    const bool real = series.at("name") == "measured";
    EXPECT_EQ(series.at("style") == "measured", real) << series.at("name");
  }
  const Json trace = Json::parse(text_of(options_.trace));
  EXPECT_GT(trace.at("traceEvents").size(), 100U);

  // The second time nothing is measured again.
  options_.study.points = Points::kResume;
  const std::string tables = report.at("sections").dump();
  ASSERT_TRUE(scaling_study(options_));
  EXPECT_EQ(Json::parse(text_of(folder_ / "study-scaling.json")).at("sections").dump(), tables);
}

TEST_F(ScalingStudy, RefusesWhatItCannotDo) {
  options_.threads = {100000};
  EXPECT_THROW(static_cast<void>(scaling_study(options_)), std::invalid_argument);
  options_.threads = {1};
  options_.scenes = {kRecording};
  options_.weak = true;
  EXPECT_THROW(static_cast<void>(scaling_study(options_)), SceneError);
}

}  // namespace
}  // namespace sweepgrid::study::scaling_study_test
