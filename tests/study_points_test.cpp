// Points of a study outlive what may happen to it: an interruption, a torn line, another program or machine.
#include <sys/resource.h>

#include <cerrno>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "scenes_data/scene_files.hpp"
#include "study/point_store.hpp"
#include "study/report_files.hpp"
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

TEST_F(PointStores, LeaveOutAWrongMemberAndNameIt) {
  put(fingerprint(), "a", 1);
  const std::string deep(100000, '[');
  const std::pair<std::string, std::string> lines[] = {
      {R"({"fingerprint":"x","of":3})", "member 'of' must be an object, is 3"},
      {R"({"fingerprint":7,"of":{}})", "member 'fingerprint' must be a text, is 7"},
      {R"({"fingerprint":"","of":{}})", "member 'fingerprint' must be a text, is \"\""},
      {R"({"fingerprint":"x","point":["b"],"value":1})", "member 'point' must be a text, is [\"b\"]"},
      {R"({"fingerprint":"x","point":"b"})", "member 'value' must be there, is absent"},
      {R"({"of":{}})", "member 'fingerprint' must be a text, is absent"},
      {"3", "it must be an object, is 3"},
      {"", "parse error"},
      {R"({"fingerprint":"x",)", "parse error"},
      {R"({"fingerprint":"x","point":"b","value":)" + deep, "nested more than 64 levels deep"}};
  for (const auto& [line, reason] : lines) append(line + "\n");
  const PointStore store = open(fingerprint());
  EXPECT_EQ(store.size(), 1U);
  std::size_t number = 3;  // after the fingerprint and the point
  for (const auto& [line, reason] : lines) {
    const std::string expected =
        file() + ": line " + std::to_string(number++) + " is no point and is left out: " + reason;
    EXPECT_NE(joined(store.notes()).find(expected), std::string::npos) << expected << "\n" << joined(store.notes());
  }
  EXPECT_EQ(joined(store.notes()).find("json.exception"), std::string::npos);
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

TEST_F(PointStores, NameFilePointAndMemberOfAValueThatIsNotAsExpected) {
  {
    PointStore store = open(fingerprint());
    store.add("a", {{"list", {{{"v", "text"}}}}});
  }
  const PointStore store = open(fingerprint());
  const auto error = [&](const std::string& key, const auto& read) {
    try {
      store.read(key, read);
    } catch (const std::runtime_error& caught) {
      return std::string(caught.what());
    }
    return std::string();
  };
  const auto read_number = [](const json& value) {
    return member_of<int>(member_of<std::vector<json>>(value, "list").at(0), "v");
  };
  const auto read_absent = [](const json& value) {
    return member_of<int>(member_of<std::vector<json>>(value, "list").at(0), "w");
  };
  EXPECT_EQ(error("a", read_number),
            file() + ": point 'a': member 'v': type must be number, but is string; --fresh measures all anew");
  EXPECT_EQ(error("a", read_absent), file() + ": point 'a': member 'w' is absent; --fresh measures all anew");
  EXPECT_EQ(error("b", read_number), file() + ": point 'b': is not there; --fresh measures all anew");
  EXPECT_EQ(store.get<json>("a").at("list").size(), 1U);
}

/// Lets no file of this process grow beyond so many bytes: a write of more takes a part, and the next one fails.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit old_{};
  void (*old_handler_)(int);
};

TEST_F(PointStores, TellWhyAPointCannotBeWrittenAndStayAsTheyWere) {
  put(fingerprint(), "a", 1);
  PointStore store = open(fingerprint());
  const std::string before = text();
  std::string error;
  {
    const FileSizeLimit limit(before.size() + 20);
    errno = EISDIR;  // of some earlier call
    try {
      store.add("b", 2);
    } catch (const std::system_error& caught) {
      error = caught.what();
    }
  }
  EXPECT_EQ(error, "cannot write " + file() + ": File too large");
  EXPECT_EQ(text(), before);
  EXPECT_EQ(store.find("b"), nullptr);
  store.add("c", 3);
  EXPECT_EQ(json::parse(text().substr(before.size())).at("point"), "c");
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

TEST_F(PointStores, RefuseNamesThatAreNoText) {
  PointStore store = open(fingerprint());
  const std::string error = error_of([&] { store.add("\xff.dump", 1); });
  EXPECT_EQ(error, file() + ": a point cannot be written: invalid UTF-8 byte at index 0: 0xFF");
}

TEST_F(PointStores, AreRegularFilesWhereLinksLead) {
  std::filesystem::create_symlink("target", file());
  put(fingerprint(), "a", 1);
  EXPECT_EQ(scene_files::read_file(directory_.path("target")), text());
  std::filesystem::remove(file());
  for (const char* target : {"/dev/full", "/dev/null"}) {
    std::filesystem::create_symlink(target, file());
    const std::string error = error_of([&] { (void)open(fingerprint()); });
    EXPECT_EQ(error, file() + ": is no regular file");
    std::filesystem::remove(file());
  }
  std::filesystem::create_directory(file());
  EXPECT_EQ(error_of([&] { (void)open(fingerprint()); }), file() + ": Is a directory");
}

/// Of the program, when the call is interrupted.
int exit_status(const std::function<void()>& call) {
  try {
    call();
  } catch (const Interrupted& interrupted) {
    return interrupted.exit_status();
  }
  return 0;
}

TEST_F(PointStores, TheFirstSignalDecidesTheExitStatus) {
  for (const auto& [signal, status] : {std::pair(SIGINT, 130), std::pair(SIGTERM, 143)}) {
    PointStore store = open(fingerprint());
    const std::string name = std::to_string(signal);
    const StudyPoint first{"a" + name, 1, [sent = signal] {
                             std::raise(sent);
                             return json(1);
                           }};
    const StudyPoint second{"b" + name, 1, [] { return json(2); }};
    EXPECT_EQ(exit_status([&] { measure_points("test", {first, second}, store); }), status);
  }
}

TEST_F(PointStores, ASecondSignalActsAsItDidBeforeTheStudy) {
  static volatile std::sig_atomic_t seen = 0;
  const auto old = std::signal(SIGTERM, [](int) { seen = seen + 1; });
  PointStore store = open(fingerprint());
  const StudyPoint twice{"a", 1, [] {
                           std::raise(SIGINT);
                           std::raise(SIGTERM);
                           return json(1);
                         }};
  EXPECT_THROW(measure_points("test", {twice, twice, {"b", 1, [] { return json(2); }}}, store), Interrupted);
  EXPECT_EQ(seen, 1);
  std::signal(SIGTERM, old);
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
    EXPECT_EQ(exit_status([&] { measure_points("test", points, store); }), 130);
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

TEST(ReportFiles, TellThatTheyCannotBeWrittenAndFollowLinks) {
  const scene_files::Directory directory;
  Report report;
  report.study = "test";
  std::filesystem::create_symlink("target", directory.path("study-test.json"));
  (void)write_report(report, directory.path(""));
  EXPECT_EQ(json::parse(scene_files::read_file(directory.path("target"))).at("study"), "test");
  std::filesystem::remove(directory.path("study-test.json"));
  std::filesystem::create_symlink("/dev/full", directory.path("study-test.json"));
  const std::string error = error_of([&] { (void)write_report(report, directory.path("")); });
  EXPECT_EQ(error, "cannot write " + directory.path("study-test.json") + ": No space left on device");
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
