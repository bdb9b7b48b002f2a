#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <CLI/CLI.hpp>

namespace sweepgrid {

/// `sweepgrid study NAME`: one subcommand for each study.
class StudyCommand {
 public:
  /// Adds the command and all studies to `app`. Each study stands in one function of study_command.cpp: add one there.
  explicit StudyCommand(CLI::App& app);

  [[nodiscard]] bool parsed() const { return command_->parsed(); }

  /// Runs the study that was asked for, once `app` has parsed. Throws std::exception with the reason;
  /// study::Interrupted when a signal ended it. False: a result was not exact.
  [[nodiscard]] bool run() const;

 private:
  struct Study {
    CLI::App* command;
    std::function<bool()> run;
  };

  void add_figures();
  void add_scaling();
  void add_stability();
  void add_accuracy();

  CLI::App* command_;
  std::vector<Study> studies_;
};

}  // namespace sweepgrid
