// The sweepgrid program: that its verifier notices every kind of wrong event, and what it answers, writes and exits
// with.

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/overlap_oracle.hpp"
#include "cli/step_times.hpp"
#include "cli/verifier.hpp"
#include "program_run.hpp"
#include "scenes_data/scene_files.hpp"

namespace sweepgrid::cli_test {
namespace {

using scene_files::read_file;

using SceneEvents = Events<SceneKey>;

SceneBox cube(double x, double radius = 0.5) {
  return SceneBox({x - radius, -radius, -radius}, {x + radius, radius, radius});
}

SceneStep inserts(const std::vector<std::pair<SceneKey, SceneBox>>& objects) {
  SceneStep step;
  for (const auto& [key, box] : objects) {
    step.inserted.push_back(key);
    step.inserted_boxes.push_back(box);
  }
  return step;
}

// Overlapping: (1, 2), (2, 3) and (8, 9).
SceneStep five_objects() {
  return inserts({{1, cube(0)}, {2, cube(0.75)}, {3, cube(1.5)}, {8, cube(9)}, {9, cube(10)}});
}
const std::vector<ScenePair> kFivePairs = {{1, 2}, {2, 3}, {8, 9}};

// What a verifier finds that got five_objects() with `events`.
Verification verify_start(const SceneEvents& events) {
  Verifier verifier;
  const bool right = verifier.check_step(five_objects(), events);
  EXPECT_EQ(right, verifier.result().ok());
  return verifier.result();
}

// What it finds when object 9 is erased after a right start, with `events`.
Verification verify_erase(const SceneEvents& events) {
  Verifier verifier;
  EXPECT_TRUE(verifier.check_step(five_objects(), {{}, kFivePairs}));
  SceneStep step;
  step.erased = {9};
  const bool right = verifier.check_step(step, events);
  EXPECT_EQ(right, verifier.result().ok());
  return verifier.result();
}

TEST(OverlapOracle, FindsWhatComparingAllPairsFinds) {
  std::mt19937 random(5);
  for (int round = 0; round < 20; ++round) {
    OverlapOracle oracle;
    std::vector<SceneBox> boxes;
    for (SceneKey key = 0; key < 60; ++key) {
      SceneBox box;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        // Whole numbers, so that many boxes only touch.
        box.min[axis] = static_cast<double>(random() % 12);
        box.max[axis] = box.min[axis] + static_cast<double>(random() % 4);
      }
      boxes.push_back(box);
      oracle.insert(key, box);
    }
    std::vector<ScenePair> expected;
    for (SceneKey a = 0; a < boxes.size(); ++a) {
      for (SceneKey b = a + 1; b < boxes.size(); ++b) {
        if (boxes[a].overlaps(boxes[b])) expected.push_back({a, b});
      }
    }
    EXPECT_EQ(oracle.pairs(), expected);
  }
}

TEST(Verifier, FindsNothingWrongWithRightEvents) {
  const Verification start = verify_start({{}, kFivePairs});
  EXPECT_TRUE(start.ok());
  EXPECT_EQ(start.pairs, 3U);
  const Verification erase = verify_erase({{{8, 9}}, {}});
  EXPECT_TRUE(erase.ok()) << erase.first_error;
  EXPECT_EQ(erase.steps, 1U);
  EXPECT_EQ(erase.pairs, 5U);
}

TEST(Verifier, NoticesAMissingBegin) {
  const Verification found = verify_start({{}, {{1, 2}, {8, 9}}});
  EXPECT_EQ(found.missing, 1U);
  EXPECT_EQ(found.first_error,
            "step 0: pair (2, 3): overlaps, but not according to the events; boxes: "
            "2 [0.25, -0.5, -0.5] to [1.25, 0.5, 0.5]; 3 [1, -0.5, -0.5] to [2, 0.5, 0.5]");
}

TEST(Verifier, NoticesAnExtraBegin) {
  const Verification found = verify_start({{}, {{1, 2}, {1, 3}, {2, 3}, {8, 9}}});
  EXPECT_EQ(found.extra, 1U);
  EXPECT_TRUE(found.first_error.starts_with("step 0: pair (1, 3): does not overlap, but does according to"));
}

TEST(Verifier, NoticesAMissingEnd) {
  const Verification found = verify_erase({});
  EXPECT_EQ(found.extra, 1U);
  EXPECT_EQ(found.first_error,
            "step 1: pair (8, 9): does not overlap, but does according to the events; boxes: "
            "8 [8.5, -0.5, -0.5] to [9.5, 0.5, 0.5]; 9 is not there");
}

TEST(Verifier, NoticesDuplicates) {
  EXPECT_EQ(verify_start({{}, {{1, 2}, {2, 3}, {2, 3}, {8, 9}}}).duplicate, 1U);
  EXPECT_EQ(verify_erase({{{8, 9}, {8, 9}}, {}}).duplicate, 1U);
}

TEST(Verifier, NoticesSpuriousEventsThatLeadToTheRightPairs) {
  EXPECT_EQ(verify_start({{{1, 3}}, kFivePairs}).spurious, 1U);        // ends what was not there
  EXPECT_EQ(verify_erase({{{8, 9}}, {{1, 2}}}).spurious, 1U);          // begins what was there
  EXPECT_EQ(verify_erase({{{1, 2}, {8, 9}}, {{1, 2}}}).spurious, 1U);  // ends and begins what went on
}

TEST(Verifier, AllowsAnEndAndABeginOfAnObjectThatWasReplaced) {
  Verifier verifier;
  EXPECT_TRUE(verifier.check_step(five_objects(), {{}, kFivePairs}));
  SceneStep step = inserts({{9, cube(9.5)}});
  step.erased = {9};
  EXPECT_TRUE(verifier.check_step(step, {{{8, 9}}, {{8, 9}}})) << verifier.result().first_error;
}

TEST(Verifier, NoticesWrongOrder) {
  EXPECT_EQ(verify_start({{}, {{2, 3}, {1, 2}, {8, 9}}}).misordered, 1U);
  EXPECT_FALSE(verify_start({{}, {{1, 2}, {3, 2}, {8, 9}}}).ok());
}

TEST(Verifier, NoticesAWrongListOfAllPairs) {
  const std::vector<ScenePair> wrong_lists[] = {
      {{1, 2}, {2, 3}}, {{1, 2}, {1, 3}, {2, 3}, {8, 9}}, {{1, 2}, {2, 3}, {8, 9}, {8, 9}}, {{2, 3}, {1, 2}, {8, 9}}};
  for (const auto& wrong : wrong_lists) {
    Verifier verifier;
    verifier.check_step(five_objects(), {{}, kFivePairs});
    EXPECT_TRUE(verifier.check_pairs(kFivePairs));
    EXPECT_FALSE(verifier.check_pairs(wrong));
  }
}

TEST(StepTimes, QuantilesAreSamples) {
  StepTimes times;
  EXPECT_EQ(times.median(), 0);
  for (int i = 200; i > 0; --i) times.samples.push_back(i);
  EXPECT_EQ(times.median(), 100);
  EXPECT_EQ(times.p99(), 198);
  EXPECT_EQ(times.quantile(1), 200);
}

class Program : public ProgramRun {
 protected:
  // Two unit cubes that meet, part and meet, beside one that comes and goes.
  [[nodiscard]] std::string small_scene() const {
    return "'" +
           directory_.write("small.dump", scene_files::as_dump({{{4, cube(0)}, {7, cube(0.5)}},
                                                                {{4, cube(0)}, {5, cube(0.25)}, {7, cube(2)}},
                                                                {{4, cube(0)}, {7, cube(1)}}})) +
           "'";
  }
};

TEST_F(Program, ExitsWithTwoAndTheReasonWhenItCannotDoWhatItIsAskedFor) {
  const std::string scene = small_scene();
  const std::string cut = "'" + directory_.write("cut.aabbs", scene_files::aabbs_header(3, 3) + "x") + "'";
  const std::pair<std::string, std::string> cases[] = {
      {"", "subcommand is required"},
      {"run", "SCENE is required"},
      {"run absent.aabbs", "absent.aabbs: neither a file nor a generator"},
      {"run " + cut, "cut.aabbs: byte 305: the header tells 4 frames of 3 objects"},
      {"info " + cut, "cut.aabbs: byte 305: the header tells 4 frames of 3 objects"},
      {"run uniform:n=0", "generator uniform: parameter n: 0 is not within"},
      {"run --threads -1 " + scene, "--threads"},
      {"run --cell round " + scene, "--cell"},
      {"run --cell-size 0 " + scene, "--cell-size"},
      {"run --cell-size wide " + scene, "--cell-size: 'wide' is not a positive finite number or 'auto'"},
      {"run --cell-size nan " + scene, "--cell-size"},
      {"run --cell-size 5m " + scene, "--cell-size"},
      {"run --diameter nan " + scene, "--diameter"},
      {"run --cell-population 0 " + scene, "--cell-population: '0' is not a positive whole number or 'auto'"},
      {"run --cell-population 2.5 " + scene, "--cell-population"},
      {"run --reduction sum " + scene, "--reduction"},
      {"run --segment-capacity 3 " + scene, "--segment-capacity"},
      {"run --scalar half " + scene, "--scalar"},
      {"run --steps -1 " + scene, "--steps"},
      {"run --diameter -1 " + scene, "--diameter"},
      {"run --quietly " + scene, "--quietly"},
      {"run --events - --json - " + scene, "--events and --json"},
      {"run --events /absent/e.csv " + scene, "cannot write /absent/e.csv"},
      {"run --json /absent/r.json " + scene, "cannot write /absent/r.json"},
  };
  for (const auto& [arguments, reason] : cases) {
    const Result result = run(arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_NE(result.err.find(reason), std::string::npos) << arguments << "\nexpected: " << reason << "\n"
                                                          << result.err;
  }
}

TEST_F(Program, KeepsTheResultsOfWhatWasWholeWhenASceneIsCut) {
  const std::string text = scene_files::as_dump({{{1, cube(0)}, {2, cube(0.5)}}, {{1, cube(0)}}, {{1, cube(1)}}});
  const std::string cut = "'" + directory_.write("cut.dump", text.substr(0, text.size() - 3)) + "'";
  const std::string whole = small_scene();
  const std::string events = directory_.path("e.csv"), json = directory_.path("r.json");
  const Result result =
      run("run --verify --events '" + events + "' --json '" + json + "' " + whole + " " + cut + " " + whole);
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("cut.dump: line 31: the file ends inside this line; the results are those of the 2 whole"),
            std::string::npos)
      << result.err;
  EXPECT_NE(result.out.find("cut"), std::string::npos) << result.out;
  EXPECT_EQ(read_file(events),
            "scene,step,event,a,b\n1,0,begin,4,7\n1,1,end,4,7\n1,1,begin,4,5\n1,2,end,4,5\n1,2,begin,4,7\n"
            "2,0,begin,1,2\n2,1,end,1,2\n"
            "3,0,begin,4,7\n3,1,end,4,7\n3,1,begin,4,5\n3,2,end,4,5\n3,2,begin,4,7\n");
  const nlohmann::json scenes = nlohmann::json::parse(read_file(json)).at("scenes");
  ASSERT_EQ(scenes.size(), 3U);
  for (const std::size_t whole_one : {0, 2}) EXPECT_TRUE(scenes[whole_one].at("error").is_null());
  EXPECT_NE(scenes[1].at("error").get<std::string>().find("line 31"), std::string::npos);
  EXPECT_EQ(scenes[1].at("steps"), 1);
  EXPECT_EQ(scenes[1].at("ends"), 1);
  EXPECT_EQ(scenes[1].at("verification").at("ok"), true);
  EXPECT_EQ(run("info " + cut + " " + whole).status, 2);
  EXPECT_NE(run("info " + cut).out.find("1 after the start"), std::string::npos);
  EXPECT_NE(run("info " + cut + " " + whole).out.find("small.dump"), std::string::npos);
}

TEST_F(Program, LeavesNoFilesWhenNoSceneHasAWholeFrame) {
  const std::string text = scene_files::as_dump({{{1, cube(0)}}});
  const std::string scene = directory_.write("cut.dump", text.substr(0, text.size() - 3));
  EXPECT_EQ(run("run --events '" + directory_.path("e.csv") + "' '" + scene + "'").status, 2);
  for (const auto& entry : std::filesystem::directory_iterator(directory_.path(""))) {
    EXPECT_EQ(entry.path().filename().string().find("e.csv"), std::string::npos) << entry.path();
  }
}

TEST_F(Program, RefusesWhatOnlyADoubleCanHoldUnlessTheEngineTakesDoubles) {
  const std::string scene =
      "'" + directory_.write("far.dump", scene_files::dump_header(5, 1, "id x y z radius") + "3 0 1e39 0 1\n") + "'";
  for (const std::string command : {"run ", "info "}) {
    const Result refused = run(command + scene);
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.err.find("far.dump: line 10: timestep 5, atom 3: the box on axis y"), std::string::npos);
    EXPECT_EQ(run(command + "--scalar double " + scene).status, 0);
  }
}

TEST_F(Program, WritesTheEventsOfEveryStep) {
  const std::string expected = "step,event,a,b\n0,begin,4,7\n1,end,4,7\n1,begin,4,5\n2,end,4,5\n2,begin,4,7\n";
  EXPECT_EQ(run("run --events - " + small_scene()).out, expected);
  EXPECT_EQ(run("run --verify --events '" + directory_.path("e.csv") + "' " + small_scene()).status, 0);
  EXPECT_EQ(read_file(directory_.path("e.csv")), expected);
  const Result two = run("run --steps 0 --events - " + small_scene() + " " + small_scene());
  EXPECT_EQ(two.out, "scene,step,event,a,b\n1,0,begin,4,7\n2,0,begin,4,7\n");
}

TEST_F(Program, GivesTheSameEventsForAllSettings) {
  const std::string scenes = "sizes:n=300,steps=5,density=0.3 clusters:dim=2,n=300,steps=5";
  const std::string expected = run("run --threads 1 --events - " + scenes).out;
  EXPECT_GT(std::count(expected.begin(), expected.end(), '\n'), 200);
  for (const char* settings : {"--threads 2", "--cell segmented --segment-capacity 4", "--cell classic --threads 3",
                               "--cell plane", "--cell batch --cell-size 2.5", "--cell rows --cell-size auto",
                               "--cell rows --reduction reporter", "--cell rows --reduction counts --threads 2",
                               "--cell rows --cell-population 1", "--cell-population auto --reduction counts"}) {
    EXPECT_EQ(run(std::string("run --verify --events - ") + settings + " " + scenes).out, expected) << settings;
  }
}

TEST_F(Program, VerifiesARecordingAndTellsAllInJson) {
  const std::string recording = std::string(SWEEPGRID_RECORDINGS) + "/lammps_pour_2200.lammpstrj.xz";
  const Result result = run("run --verify --steps 10 --scalar double --step-method cells --json - '" + recording + "'");
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("verified: 10 steps, "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("0 missing, 0 extra, 0 duplicate, 0 spurious"), std::string::npos);
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["schema"], "sweepgrid-run");
  EXPECT_EQ(json["schema_version"], 2);
  EXPECT_EQ(json["settings"]["scalar"], "double");
  EXPECT_EQ(json["settings"]["reduction"], "reporter");
  EXPECT_EQ(json["settings"]["step_method"], "cells");
  EXPECT_EQ(json["settings"]["cell_population"], "auto");
  const auto& scene = json["scenes"].at(0);
  EXPECT_EQ(scene["objects"]["first"], 2150);
  EXPECT_EQ(scene["pairs"]["first"], 7362);
  EXPECT_EQ(scene["steps"], 10);
  EXPECT_EQ(scene["step_ms"]["samples"].size(), 10U);
  EXPECT_EQ(scene["verification"]["ok"], true);
  EXPECT_GE(scene["grid"]["grids"], 1);
  EXPECT_GT(scene["grid"]["cells"], 0);
  EXPECT_GT(scene["grid"]["cell_size"], 0);
  EXPECT_EQ(scene["counters"]["begins"].get<int>() - scene["counters"]["ends"].get<int>(), scene["pairs"]["last"]);
}

TEST_F(Program, TakesASetupFromAFileAndVerifiesWhatItPromises) {
  const std::string scenes = "uniform:n=300,steps=6,moving=1,density=0.2 uniform:n=300,steps=6,dim=2,density=0.2";
  const auto verified = [&](const std::string& setup) {
    const std::string file = directory_.write("setup.json", setup);
    const Result result = run("run --verify --json - --config '" + file + "' " + scenes);
    EXPECT_EQ(result.status, 0) << setup << result.err;
    return nlohmann::json::parse(result.out).at("scenes").at(0).at("verification");
  };
  EXPECT_EQ(verified(R"({"scalar": "double"})").at("promised"), "exact");
  EXPECT_EQ(verified(R"({"scalar": "double", "config": {"cell_population": 2, "threads": 2}})").at("extra"), 0);
  for (const char* setup : {R"({"scalar": "float", "rounding": "outward", "axes": [0, 1], "tune": {"any": "thing"}})",
                            R"({"scalar": "double", "config": {"envelope": {"margin": 0.5}}})",
                            R"({"scalar": "float", "config": {"envelope": {"swept": true}}})",
                            R"({"config": {"envelope": {"stride": 3, "margin": 0.2, "on_violation": "query"}}})",
                            R"({"scalar": "int16", "quantizer": {"origin": [5, 5, 0], "resolution": 0.125}})"}) {
    const nlohmann::json found = verified(setup);
    EXPECT_EQ(found.at("promised"), "superset only") << setup;
    EXPECT_EQ(found.at("missing"), 0) << setup;
    EXPECT_GT(found.at("extra"), 0) << setup;
  }
  const nlohmann::json may_miss = verified(R"({"scalar": "double", "config": {"envelope": {"stride": 3}}})");
  EXPECT_EQ(may_miss.at("promised"), "may miss");
  EXPECT_GT(may_miss.at("missing"), 0);
}

// Of sizes and types of boxes at which compilers choose other instructions.
TEST_F(Program, VerifiesTheWholeRecordingOfGrains) {
  const std::string recording = std::string(SWEEPGRID_RECORDINGS) + "/lammps_pour_2200.lammpstrj.xz";
  const Result result = run("run --verify --threads 1 '" + recording + "'");
  EXPECT_EQ(result.status, 0) << result.out << result.err;
}

TEST_F(Program, RefusesASetupThatIsNoneAndNamesWhy) {
  const std::pair<std::string, std::string> cases[] = {
      {"{", "setup.json: "},
      {"[]", "setup is [], not an object"},
      {R"({"schema": "sweepgrid-run"})", "setup::schema is \"sweepgrid-run\""},
      {R"({"schema_version": 2})", "setup::schema_version is 2, but must be 1"},
      {R"({"scalars": "float"})", "setup has no member 'scalars'"},
      {R"({"scalar": "half"})", "setup::scalar is \"half\""},
      {R"({"scalar": "double", "rounding": "outward"})", "setup::rounding is \"outward\", but must be \"none\""},
      {R"({"axes": [0, 0]})", "setup::axes is [0,0]"},
      {R"({"axes": [2]})", "setup::axes is [2]"},
      {R"({"scalar": "int16"})", "setup::quantizer"},
      {R"({"scalar": "float", "quantizer": {}})", "setup::quantizer"},
      {R"({"scalar": "int32", "quantizer": {"resolution": 0}})", "quantizer::resolution is 0"},
      {R"({"scalar": "int32", "quantizer": {"origin": [1, 2]}})", "quantizer::origin is [1,2]"},
      {R"({"scalar": "int32", "quantizer": {"step": 1}})", "quantizer has no member 'step'"},
      {R"({"config": {"threads": -1}})", "Config::threads is -1"},
      {R"({"config": {"step_bytes": 10}})", "step 0: the step takes more memory for its lists than step_bytes"},
  };
  for (const auto& [setup, reason] : cases) {
    const Result result = run("run uniform:n=10 --config '" + directory_.write("setup.json", setup) + "'");
    EXPECT_EQ(result.status, 2) << setup;
    EXPECT_NE(result.err.find(reason), std::string::npos) << setup << "\n" << result.err;
  }
  EXPECT_NE(run("run uniform:n=10 --config /absent.json").err.find("cannot read /absent.json"), std::string::npos);
  const Result both = run("run uniform:n=10 --cell rows --config '" + directory_.write("setup.json", "{}") + "'");
  EXPECT_EQ(both.status, 2) << "told twice";
  EXPECT_EQ(run("run uniform:n=10 --threads 2 --config '" + directory_.path("setup.json") + "'").status, 0);
}

TEST_F(Program, RunsWhatItHasTunedAndFindsThePromiseKept) {
  const std::string setup = "'" + directory_.path("setup.json") + "'";
  const std::pair<std::string, std::string> cases[] = {
      {"pile:n=300,moving=1,layers=1,density=0.3,steps=20", ""},
      {"resting:n=300,steps=20,density=0.2", "--extra 0"},
      {"far:n=300,steps=20,density=0.2,offset=1e8", "--missed 0 --threads 2"},
      {"fast:n=300,steps=20,density=0.2", "--truth T1"},
      {"turning:n=300,steps=20,churn=0.01", "--truth T2 --extra 90%"},
      {"uniform:n=300,steps=20,dim=2,density=0.2", "--missed 5%"},
      {std::string(SWEEPGRID_RECORDINGS) + "/lammps_pour_2200.lammpstrj.xz", "--steps 8 --extra 0.5"}};
  for (const auto& [scene, demand] : cases) {
    const Result tuned = run("tune '" + scene + "' --narrow-cost 50 --json " + setup + " " + demand);
    EXPECT_EQ(tuned.status, 0) << scene << tuned.err;
    EXPECT_NE(tuned.out.find("  guarantee "), std::string::npos) << tuned.out;
    const Result result = run("run --verify --json - --steps 20 --config " + setup + " '" + scene + "'");
    EXPECT_EQ(result.status, 0) << scene << result.err;
    const nlohmann::json found = nlohmann::json::parse(result.out).at("scenes").at(0).at("verification");
    if (demand.starts_with("--missed 5%")) continue;
    EXPECT_NE(found.at("promised"), "may miss") << scene;
    EXPECT_EQ(found.at("missing"), 0) << scene;
    if (demand == "--extra 0") {
      EXPECT_EQ(found.at("extra"), 0) << scene;
    }
  }
}

TEST_F(Program, SaysWhenNothingMeetsADemand) {
  const Result none = run("tune fast:n=100,steps=10 --truth T1 --extra 0 --narrow-cost 50");
  EXPECT_EQ(none.status, 1);
  EXPECT_NE(none.err.find("no configuration meets the demand"), std::string::npos) << none.err;
  EXPECT_NE(none.err.find("nearest: "), std::string::npos) << none.err;
  EXPECT_EQ(none.out, "");
  const std::pair<std::string, std::string> cases[] = {
      {"tune", "SCENE is required"},
      {"tune absent.aabbs --narrow-cost 1", "absent.aabbs"},
      {"tune uniform:n=10,steps=0 --narrow-cost 1", "there is no step after the start"},
      {"tune bad:n=100,steps=20 --narrow-cost 1", "is not finite, or has min > max"},
      {"tune uniform:n=10 --truth T3", "--truth"},
      {"tune uniform:n=10 --missed 2", "--missed: '2' is no part"},
      {"tune uniform:n=10 --extra five", "--extra: 'five' is no part"},
      {"tune uniform:n=10 --narrow-cost -1", "--narrow-cost"},
      {"tune uniform:n=10 --steps 0", "--steps"},
      {"tune uniform:n=10 --json /absent/t.json", "cannot write /absent/t.json"}};
  for (const auto& [arguments, reason] : cases) {
    const Result result = run(arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_NE(result.err.find(reason), std::string::npos) << arguments << "\n" << result.err;
  }
}

TEST_F(Program, DescribesScenes) {
  const Result result = run("info '" + std::string(SWEEPGRID_RECORDINGS) + "/bullet_towers_4000.aabbs.xz'");
  EXPECT_EQ(result.status, 0);
  for (const char* line :
       {"  format             aabbs, xz\n", "  steps              100 after the start\n",
        "  overlapping pairs  3306 first, 3440 last\n", "  objects            4000 first, 4000 last"}) {
    EXPECT_NE(result.out.find(line), std::string::npos) << line << result.out;
  }
}

TEST_F(Program, TellsItsVersionAndItsUse) {
  EXPECT_EQ(run("--version").status, 0);
  EXPECT_TRUE(run("--version").out.starts_with("sweepgrid "));
  const Result help = run("run --help");
  EXPECT_EQ(help.status, 0);
  EXPECT_NE(help.out.find("--segment-capacity"), std::string::npos);
}

}  // namespace
}  // namespace sweepgrid::cli_test
