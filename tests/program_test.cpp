// What the program writes: refused where two files are one, told where it cannot be written, gone when it is ended.

#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <set>
#include <string>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <unistd.h>

#include "program_run.hpp"

namespace sweepgrid::program_test {
namespace {

using scene_files::read_file;

constexpr const char* kScene = " uniform:n=50,steps=2 ";

class ProgramOutputs : public ProgramRun {
 protected:
  // Of a run that is ended by `signal` once it has opened its events file; as waitpid() tells it.
  [[nodiscard]] int end_by(int signal) const {
    std::string program = SWEEPGRID_PROGRAM;
    std::string events = directory_.path("events.csv");
    std::string words[] = {program, "run", "uniform:n=100,steps=100000000", "--threads", "1", "--events", events};
    char* arguments[8] = {};
    for (std::size_t i = 0; i < 7; ++i) arguments[i] = words[i].data();
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    EXPECT_EQ(posix_spawn(&child, program.c_str(), &actions, nullptr, arguments, environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    const std::string temporary = events + "." + std::to_string(child) + ".tmp";
    int status = 0;
    while (!std::filesystem::exists(temporary) && waitpid(child, &status, WNOHANG) == 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    kill(child, signal);
    EXPECT_EQ(waitpid(child, &status, 0), child);
    return status;
  }
};

TEST_F(ProgramOutputs, AreRefusedWhereTwoAreOneFile) {
  const std::string scene =
      directory_.write("scene.dump", scene_files::as_dump({{{1, SceneBox({0, 0, 0}, {1, 1, 1})}}}));
  const std::string file = directory_.write("setup.json", "{}");
  const auto link = [&](const char* target, const char* name) {
    std::filesystem::create_symlink(target, directory_.path(name));
    return quoted(name);
  };
  const std::string to_scene = link("scene.dump", "to-scene");
  const std::string to_nothing = link("x", "to-nothing");
  const std::string points = link("study-scaling.points.jsonl", "to-points");
  const std::string x = quoted("x");
  const std::string out = " --quick --out '" + directory_.path("") + "' ";
  const std::set<std::string> before = names();
  const std::pair<std::string, std::string> cases[] = {
      {"run --events " + x + " --json " + x + kScene, "--events and --json are the same file"},
      {"run --events " + to_nothing + " --json " + x + kScene, "--events and --json are the same file"},
      {"run --events /dev/stdout --json -" + std::string(kScene),
       "--events and --json cannot both be the standard out"},
      {"run --events " + to_scene + " '" + scene + "'", "SCENE and --events are the same file"},
      {"run --json '" + file + "' --config '" + file + "'" + kScene, "--config and --json are the same file"},
      {"run --json " + quoted("stdout") + kScene, "--json and the standard output are the same file"},
      {"tune --json " + to_scene + " '" + scene + "'", "SCENE and --json are the same file"},
      {"study scaling --trace " + points + out + kScene, "the file of points and --trace are the same file"},
      {"study scaling --trace " + to_scene + out + "'" + scene + "'", "SCENE and --trace are the same file"},
      {"run --events ''" + std::string(kScene), "--events: names no file"},
      {"run --json ''" + std::string(kScene), "--json: names no file"},
  };
  for (const auto& [arguments, reason] : cases) {
    const Result result = run(arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_NE(result.err.find(reason), std::string::npos) << arguments << "\n" << result.err;
    EXPECT_EQ(names(), before) << arguments;
  }
  EXPECT_EQ(read_file(file), "{}");
}

TEST_F(ProgramOutputs, OfStudiesAreNotOneFileEither) {
  std::filesystem::create_symlink("same", directory_.path("study-figures.json"));
  std::filesystem::create_symlink("same", directory_.path("study-figures.points.jsonl"));
  const Result result = run("study figures --quick --figure 8 --out '" + directory_.path("") + "'");
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("the file of points and the report as JSON are the same file"), std::string::npos)
      << result.err;
}

TEST_F(ProgramOutputs, ThatCannotBeWrittenAreToldByEveryCommand) {
  const std::string to_full[] = {std::string("run") + kScene,
                                 "run --events -" + std::string(kScene),
                                 "run --json /dev/stdout" + std::string(kScene),
                                 std::string("info") + kScene,
                                 "tune --narrow-cost 50 uniform:n=50,steps=4",
                                 "tune --narrow-cost 50 uniform:n=50,steps=4 --json " + quoted("tuned.json"),
                                 "--help",
                                 "run --help",
                                 "study --help",
                                 "study scaling --help",
                                 "--version"};
  for (const std::string& arguments : to_full) {
    const Result result = run(arguments, "/dev/full");
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_NE(result.err.find("cannot write"), std::string::npos) << arguments << result.err;
    EXPECT_NE(result.err.find("No space left on device"), std::string::npos) << arguments << result.err;
  }
  for (const std::string& arguments :
       {"run --events /dev/full" + std::string(kScene), "run --json /dev/full" + std::string(kScene),
        std::string("tune --narrow-cost 50 --json /dev/full uniform:n=50,steps=4")}) {
    const Result result = run(arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_NE(result.err.find("cannot write /dev/full: No space left"), std::string::npos) << arguments << result.err;
  }
  const Result table_on_stderr = run("run --json -" + std::string(kScene), "", "/dev/full");
  EXPECT_EQ(table_on_stderr.status, 2);
  EXPECT_EQ(run("run absent.aabbs", "", "/dev/full").status, 2) << "nor can the reason be told";
}

TEST_F(ProgramOutputs, ThatAreClosedAreNoFilesToWriteInto) {
  const std::string events = quoted("events.csv");
  // What is opened first would get the number of the standard output, and with it the table.
  const Result result = run("run --events " + events + kScene + ">&- 2>/dev/null #");
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(names(), std::set<std::string>{});
  EXPECT_EQ(run("run --events " + events + kScene + "2>&- >/dev/null #").status, 0);
  EXPECT_TRUE(read_file(directory_.path("events.csv")).starts_with("step,event,a,b\n"));
}

TEST_F(ProgramOutputs, GoThroughPipesDevicesAndLinks) {
  const std::string events = run("run --events -" + std::string(kScene)).out;
  EXPECT_EQ(run("run --events /dev/stdout" + std::string(kScene)).out, events);
  EXPECT_EQ(run("run --events /dev/null --json /dev/null" + std::string(kScene)).status, 0);
  std::filesystem::create_symlink("target.csv", directory_.path("link.csv"));
  EXPECT_EQ(run("run --events " + quoted("link.csv") + kScene).status, 0);
  EXPECT_EQ(read_file(directory_.path("target.csv")), events);
  EXPECT_TRUE(std::filesystem::is_symlink(directory_.path("link.csv")));
  EXPECT_EQ(run("run --events /dev/fd/3" + std::string(kScene) + "3>" + quoted("third.csv")).status, 0);
  EXPECT_EQ(read_file(directory_.path("third.csv")), events);
}

TEST_F(ProgramOutputs, ThatAreNotCompleteAreGoneWhenASignalEndsIt) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const int status = end_by(signal);
    EXPECT_TRUE(WIFSIGNALED(status)) << signal << ": exit status " << WEXITSTATUS(status);
    EXPECT_EQ(WTERMSIG(status), signal);
    EXPECT_EQ(names(), std::set<std::string>{}) << signal;
  }
}

}  // namespace
}  // namespace sweepgrid::program_test
