// Points of a study outlive what may happen to it: an interruption, a torn line, another program or machine.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "scenes_data/scene_files.hpp"
#include "study/point_store.hpp"
#include "study/study_points.hpp"
#include "study/study_progress.hpp"

namespace sweepgrid::study::study_points_test {
namespace {

using nlohmann::json;

class PointStores : public testing::Test {
 protected:
  static Fingerprint fingerprint(int size = 1, const std::string& program = "abc", const std::string& machine = "m") {
    return {"test", {{"size", size}}, program, machine};
  }
  [[nodiscard]] std::string folder() const { return directory_.path(""); }
  [[nodiscard]] std::string file() const { return directory_.path("study-test.points.jsonl"); }
  [[nodiscard]] PointStore open(const Fingerprint& fingerprint, Points points = Points::kKeep) const {
    return PointStore(folder(), fingerprint, points);
  }
  [[nodiscard]] std::string text() const {
    std::ifstream stream(file());
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }
  void append(const std::string& text) const { std::ofstream(file(), std::ios::app) << text; }

  static std::string joined(const std::vector<std::string>& notes) {
    std::string result;
    for (const std::string& note : notes) result += note + "\n";
    return result;
  }

  void put(const Fingerprint& fingerprint, const std::string& key, int value) const {
    open(fingerprint).add(key, {{"v", value}});
  }

  scene_files::Directory directory_;
};

TEST_F(PointStores, KeepWhatWasAdded) {
  put(fingerprint(), "a", 1);
  put(fingerprint(), "b", 2);
  const PointStore store = open(fingerprint());
  EXPECT_EQ(store.size(), 2U);
  ASSERT_NE(store.find("a"), nullptr);
  EXPECT_EQ(*store.find("b"), json({{"v", 2}}));
  EXPECT_EQ(store.find("c"), nullptr);
  EXPECT_NE(joined(store.notes()).find("2 finished points are taken"), std::string::npos);
}

TEST_F(PointStores, DropATornLastLineAndGoOn) {
  put(fingerprint(), "a", 1);
  const std::string whole = text();
  append(R"({"fingerprint":"12","point":"b","val)");
  {
    PointStore store = open(fingerprint());
    EXPECT_EQ(text(), whole);
    EXPECT_EQ(store.size(), 1U);
    EXPECT_NE(joined(store.notes()).find("last line was not written to the end"), std::string::npos);
    store.add("b", 2);
  }
  const PointStore store = open(fingerprint());
  EXPECT_EQ(store.size(), 2U);
  EXPECT_EQ(store.notes().size(), 1U);
}

TEST_F(PointStores, LeaveOutALineThatIsNoPoint) {
  put(fingerprint(), "a", 1);
  append("some text\n[1]\n");
  put(fingerprint(), "b", 1);
  const PointStore store = open(fingerprint());
  EXPECT_EQ(store.size(), 2U);
  EXPECT_NE(joined(store.notes()).find("line 3 is no point"), std::string::npos);
  EXPECT_NE(joined(store.notes()).find("line 4 is no point"), std::string::npos);
}

TEST_F(PointStores, NeverMixStudies) {
  const Fingerprint others[] = {fingerprint(2), fingerprint(1, "abd"), fingerprint(1, "abc", "n")};
  const std::string names[] = {"parameters", "program (abd; now abc)", "machine (n; now m)"};
  for (int i = 0; i < 3; ++i) {
    std::filesystem::remove(file());
    put(others[i], "a", 1);
    const PointStore store = open(fingerprint());
    EXPECT_EQ(store.find("a"), nullptr) << i;
    EXPECT_NE(joined(store.notes()).find("differs in: " + names[i]), std::string::npos) << joined(store.notes());
  }
}

TEST_F(PointStores, HoldPointsOfSeveralStudies) {
  put(fingerprint(1), "a", 1);
  put(fingerprint(2), "a", 2);
  put(fingerprint(1), "b", 1);
  EXPECT_EQ(open(fingerprint(1)).size(), 2U);
  EXPECT_EQ(*open(fingerprint(2)).find("a"), json({{"v", 2}}));
}

TEST_F(PointStores, FreshDropsTheStudysOwnPointsOnly) {
  put(fingerprint(1), "a", 1);
  put(fingerprint(2), "a", 2);
  {
    PointStore store = open(fingerprint(1), Points::kFresh);
    EXPECT_EQ(store.size(), 0U);
    store.add("b", 3);
  }
  EXPECT_EQ(open(fingerprint(1)).find("a"), nullptr);
  EXPECT_NE(open(fingerprint(1)).find("b"), nullptr);
  EXPECT_EQ(open(fingerprint(2)).size(), 1U);
}

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(PointStores, ResumeInsistsOnPoints) {
  put(fingerprint(2), "a", 1);
  const std::string error = error_of([&] { (void)open(fingerprint(1), Points::kResume); });
  EXPECT_NE(error.find("study-test.points.jsonl: there are no points of this study to resume"), std::string::npos);
  EXPECT_NE(error.find("differs in: parameters"), std::string::npos) << error;
  EXPECT_EQ(open(fingerprint(2), Points::kResume).size(), 1U);
}

TEST_F(PointStores, BelongToOneProcessAtATime) {
  const PointStore store = open(fingerprint());
  const std::string error = error_of([&] { (void)open(fingerprint()); });
  EXPECT_NE(error.find("another study is writing to it"), std::string::npos) << error;
}

TEST_F(PointStores, InterruptedStudyKeepsItsPointsAndGoesOn) {
  std::vector<std::string> measured;
  const auto point = [&](const std::string& key, bool interrupt) {
    return StudyPoint{key, 1, [&measured, key, interrupt] {
                        measured.push_back(key);
                        if (interrupt) std::raise(SIGINT);
                        return json(key);
                      }};
  };
  {
    PointStore store = open(fingerprint());
    const std::vector<StudyPoint> points = {point("a", false), point("b", true), point("c", false)};
    EXPECT_THROW(measure_points("test", points, store), Interrupted);
  }
  EXPECT_EQ(measured, (std::vector<std::string>{"a", "b"}));
  PointStore store = open(fingerprint());
  measure_points("test", {point("a", false), point("b", false), point("c", false)}, store);
  EXPECT_EQ(measured, (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_EQ(store.size(), 3U);
}

TEST(StudyProgress, ReckonsTheRestFromWhatWasMeasured) {
  StudyProgress progress("test", 4, 10);
  EXPECT_DOUBLE_EQ(progress.remaining(), 10);
  progress.end(2, 6);  // three times as slow as expected
  EXPECT_DOUBLE_EQ(progress.remaining(), 24);
  progress.skip(5);
  EXPECT_DOUBLE_EQ(progress.remaining(), 9);
  EXPECT_EQ(duration_text(59.5), "1 min 0 s");
  EXPECT_EQ(duration_text(12), "12 s");
  EXPECT_EQ(duration_text(3660), "1 h 1 min");
}

TEST(StudyOptions, NameTheFolderThatCannotBeWrittenInto) {
  const std::string error = error_of([] { (void)make_out_folder({.out = "/proc/nowhere"}); });
  EXPECT_NE(error.find("cannot write into the folder /proc/nowhere"), std::string::npos) << error;
  const scene_files::Directory directory;
  const std::string file = directory.write("file", "");
  const std::string no_folder = error_of([&] { (void)make_out_folder({.out = file}); });
  EXPECT_NE(no_folder.find(file), std::string::npos) << no_folder;
}

}  // namespace
}  // namespace sweepgrid::study::study_points_test
