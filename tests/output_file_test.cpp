// Outputs: whole or not at all, whatever ends the process; through links, and to what is no regular file.
#include "cli/output_file.hpp"

#include <sys/stat.h>
#include <sys/wait.h>

#include <csignal>
#include <filesystem>
#include <functional>
#include <string>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "scenes_data/scene_files.hpp"

namespace sweepgrid::output_file_test {
namespace {

namespace fs = std::filesystem;
using scene_files::Directory;
using scene_files::read_file;

void write_whole(const std::string& path, const std::string& text) {
  OutputFile file(path);
  file.write(text);
  file.commit();
}

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::system_error& error) {
    return error.what();
  }
  return "no error";
}

std::ptrdiff_t files_in(const Directory& directory) {
  const auto files = fs::directory_iterator(directory.path(""));
  return std::distance(begin(files), end(files));
}

// What becomes of a process that does `work`; as waitpid() tells it.
int end_of_child(const std::function<void()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    work();
    _exit(0);
  }
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return status;
}

TEST(OutputFile, IsThereAsAWholeOrNotAtAll) {
  const Directory directory;
  const std::string path = directory.write("out", "old");
  {
    OutputFile file(path);
    file.write("new");
    EXPECT_EQ(read_file(path), "old");
  }
  EXPECT_EQ(read_file(path), "old");
  OutputFile file(path);
  file.write("new");
  file.commit();
  EXPECT_EQ(read_file(path), "new");
  EXPECT_EQ(files_in(directory), 1);
}

TEST(OutputFile, TellsThatTheDeviceIsFullAndLeavesItInPlace) {
  EXPECT_EQ(error_of([] { write_whole("/dev/full", "text"); }), "cannot write /dev/full: No space left on device");
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST(OutputFile, IsWrittenThroughLinksAlsoToNothing) {
  const Directory directory;
  fs::create_directory(directory.path("folder"));
  fs::create_symlink("folder", directory.path("linked"));
  fs::create_symlink("../target", directory.path("folder/second"));
  fs::create_symlink(directory.path("linked/second"), directory.path("first"));
  for (const char* text : {"to nothing", "to what is there"}) {
    write_whole(directory.path("first"), text);
    EXPECT_EQ(read_file(directory.path("target")), text);
    EXPECT_TRUE(fs::is_symlink(directory.path("first")));
    EXPECT_TRUE(fs::is_symlink(directory.path("folder/second")));
  }
  fs::create_symlink(directory.path("absent/file"), directory.path("lost"));
  EXPECT_NE(error_of([&] { write_whole(directory.path("lost"), ""); }).find("No such file"), std::string::npos);
  fs::create_symlink("ring", directory.path("ring"));
  EXPECT_EQ(error_of([&] { write_whole(directory.path("ring"), ""); }),
            "cannot write " + directory.path("ring") + ": Too many levels of symbolic links");
}

TEST(OutputFile, KeepsThePermissionsOfWhatItReplaces) {
  const Directory directory;
  const std::string path = directory.write("out", "old");
  fs::permissions(path, fs::perms(0751));
  write_whole(path, "new");
  EXPECT_EQ(fs::status(path).permissions(), fs::perms(0751));
}

TEST(OutputFile, WritesToPipesAndDescriptorsAsTheyAre) {
  const Directory directory;
  const std::string pipe_path = directory.path("pipe");
  ASSERT_EQ(mkfifo(pipe_path.c_str(), 0600), 0);
  fs::create_symlink("pipe", directory.path("link"));
  std::string received;
  std::thread reader([&] { received = read_file(pipe_path); });
  write_whole(directory.path("link"), "through a pipe");
  reader.join();
  EXPECT_EQ(received, "through a pipe");
  EXPECT_TRUE(fs::is_fifo(pipe_path));

  // As by a shell's 3>FILE: what holds the descriptor and what is already there must stay.
  const std::string path = directory.path("out");
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_EQ(write(descriptor, "before, ", 8), 8);
  fs::create_symlink("/dev/fd/" + std::to_string(descriptor), directory.path("named"));
  write_whole(directory.path("named"), "then");
  ASSERT_EQ(write(descriptor, ", after", 7), 7);
  close(descriptor);
  EXPECT_EQ(read_file(path), "before, then, after");
  EXPECT_NE(error_of([&] { write_whole(directory.path("named"), ""); }).find("Bad file descriptor"), std::string::npos);
}

TEST(OutputFile, IsRemovedWhenASignalEndsTheProcessWhichStillDiesByIt) {
  const Directory directory;
  const std::string path = directory.write("out", "old");
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGPIPE, SIGXCPU, SIGXFSZ, SIGABRT, SIGUSR1, SIGALRM}) {
    const int status = end_of_child([&] {
      OutputFile first(path);
      OutputFile second(directory.path("other"));
      first.write("new");
      write_whole(directory.path("whole"), "whole");
      if (files_in(directory) == 4) raise(signal);
    });
    ASSERT_TRUE(WIFSIGNALED(status)) << signal << ": status " << WEXITSTATUS(status);
    EXPECT_EQ(WTERMSIG(status), signal);
    EXPECT_EQ(files_in(directory), 2) << signal;
    EXPECT_EQ(read_file(path), "old");
    EXPECT_EQ(read_file(directory.path("whole")), "whole");
    fs::remove(directory.path("whole"));
  }
}

TEST(OutputFile, LeavesSignalsAloneThatAreIgnoredOrHandled) {
  const Directory directory;
  const int status = end_of_child([&] {
    static volatile std::sig_atomic_t handled = 0;
    std::signal(SIGHUP, SIG_IGN);
    std::signal(SIGTERM, [](int) { handled = 1; });
    OutputFile file(directory.path("out"));
    raise(SIGHUP);
    raise(SIGTERM);
    file.commit();
    _exit(handled == 1 ? 7 : 8);
  });
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7);
  EXPECT_TRUE(fs::exists(directory.path("out")));
}

TEST(OutputFile, OfAProcessIsNotRemovedBySignalsToItsChildren) {
  const Directory directory;
  OutputFile file(directory.path("out"));
  const int status = end_of_child([] { raise(SIGTERM); });
  EXPECT_TRUE(WIFSIGNALED(status));
  file.commit();
  EXPECT_TRUE(fs::exists(directory.path("out")));
}

}  // namespace
}  // namespace sweepgrid::output_file_test
