#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "scenes_data/scene_files.hpp"

namespace sweepgrid {

/// Runs the program in a directory of its own.
class ProgramRun : public testing::Test {
 protected:
  struct Result {
    int status = -1;
    std::string out;
    std::string err;
  };

  /// `arguments`: as a shell takes them. `out`, `err`: where its output goes; empty: into the result.
  [[nodiscard]] Result run(const std::string& arguments, const std::string& out = "",
                           const std::string& err = "") const {
    const std::string out_file = out.empty() ? directory_.path("stdout") : out;
    const std::string err_file = err.empty() ? directory_.path("stderr") : err;
    const std::string command =
        std::string("'") + SWEEPGRID_PROGRAM + "' " + arguments + " >'" + out_file + "' 2>'" + err_file + "'";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, out.empty() ? scene_files::read_file(out_file) : "",
            err.empty() ? scene_files::read_file(err_file) : ""};
  }

  /// The path of a file in the directory, for the shell.
  [[nodiscard]] std::string quoted(const std::string& name) const { return "'" + directory_.path(name) + "'"; }

  /// What lies in the directory, but for what the program printed.
  [[nodiscard]] std::set<std::string> names() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(directory_.path(""))) {
      names.insert(entry.path().filename().string());
    }
    names.erase("stdout");
    names.erase("stderr");
    return names;
  }

  scene_files::Directory directory_;
};

}  // namespace sweepgrid
