// No output is one file with another output or an input, under whatever names.
#include "cli/distinct_files.hpp"

#include <sys/stat.h>

#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "scenes_data/scene_files.hpp"

namespace sweepgrid::distinct_files_test {
namespace {

namespace fs = std::filesystem;

class DistinctFiles : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return directory_.path(name); }

  static std::string refusal(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs = {}) {
    try {
      check_distinct(outputs, inputs);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  }
  static std::string refusal_of(const std::string& a, const std::string& b) {
    const std::string as_outputs = refusal({{"--a", a}, {"--b", b}});
    EXPECT_EQ(as_outputs.empty(), refusal({{"--b", b}}, {{"--a", a}}).empty()) << a << " " << b;
    return as_outputs;
  }

  scene_files::Directory directory_;
};

TEST_F(DistinctFiles, AreOneUnderAnyNames) {
  fs::create_directory(path("folder"));
  fs::create_directory_symlink("folder", path("other"));
  fs::create_symlink("folder/absent", path("dangling"));
  fs::create_symlink("dangling", path("chain"));
  (void)directory_.write("there", "");
  fs::create_hard_link(path("there"), path("hard"));
  fs::create_symlink("there", path("soft"));
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  const std::pair<std::string, std::string> same[] = {{"absent", "absent"},
                                                      {"absent", "./absent"},
                                                      {"absent", "folder/../absent"},
                                                      {"folder/absent", "dangling"},
                                                      {"other/absent", "chain"},
                                                      {"there", "there"},
                                                      {"there", "hard"},
                                                      {"soft", "other/../hard"},
                                                      {"pipe", "./pipe"},
                                                      {"absent/x", "absent/y/../x"},
                                                      {"folder/new", "other/./new"}};
  for (const auto& [a, b] : same) {
    EXPECT_NE(refusal_of(path(a), path(b)).find("--a and --b are the same file: "), std::string::npos) << a << " " << b;
  }
  const std::pair<std::string, std::string> apart[] = {
      {"absent", "folder/absent"}, {"there", "absent"}, {"soft", "dangling"}, {"pipe", "there"}, {"absent", "Absent"}};
  for (const auto& [a, b] : apart) EXPECT_EQ(refusal_of(path(a), path(b)), "") << a << " " << b;
}

TEST_F(DistinctFiles, NameBothAndTheirPaths) {
  EXPECT_EQ(refusal({{"--events", path("x")}, {"--json", path("./x")}}),
            "--events and --json are the same file: " + path("x") + " and " + path("./x"));
  EXPECT_EQ(refusal({{"--json", path("x")}}, {{"--config", path("x")}}),
            "--config and --json are the same file: " + path("x"));
  EXPECT_EQ(refusal({{"--events", "-"}, {"--json", "/dev/stdout"}}),
            "--events and --json cannot both be the standard output");
}

TEST_F(DistinctFiles, MayBeTheSameDeviceWhichKeepsNothing) {
  EXPECT_EQ(refusal_of("/dev/null", "/dev/null"), "");
  EXPECT_EQ(refusal({{"--a", ""}, {"--b", ""}}, {{"--c", ""}}), "") << "not told";
}

TEST_F(DistinctFiles, AreNotWhatTheStandardOutputWasSentTo) {
  const int saved = dup(STDOUT_FILENO);
  const int file = open(path("out").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  std::fflush(stdout);
  dup2(file, STDOUT_FILENO);
  const std::string by_path = refusal({{"--json", path("out")}});
  const std::string by_descriptor = refusal({{"--json", "/dev/stdout"}});
  const std::string again = refusal({{"--json", "/dev/fd/" + std::to_string(file)}});
  dup2(saved, STDOUT_FILENO);
  close(saved);
  close(file);
  EXPECT_EQ(by_path, "--json and the standard output are the same file: " + path("out"));
  EXPECT_EQ(by_descriptor, "");
  EXPECT_NE(again, "");
}

TEST_F(DistinctFiles, TakesScenesForFilesUnlessTheyAreGenerated) {
  const std::vector<NamedFile> files = files_among({"uniform:n=10", path("a.dump"), "far"});
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0].path, path("a.dump"));
}

}  // namespace
}  // namespace sweepgrid::distinct_files_test
