#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "tune/demand.hpp"
#include "tune/scene_sample.hpp"

namespace sweepgrid {

/// `sweepgrid tune SCENE`.
class TuneCommand {
 public:
  /// Adds the command to `app`.
  explicit TuneCommand(CLI::App& app);

  [[nodiscard]] bool parsed() const { return command_->parsed(); }

  /// Tunes, once `app` has parsed. False, with what came nearest on stderr: no configuration meets the demand.
  /// Throws std::exception with the reason for bad options and scenes, and for a file that cannot be written.
  [[nodiscard]] bool run() const;

 private:
  CLI::App* command_;
  tune::SceneText scene_;
  tune::Demand demand_;
  std::string missed_ = "0";
  std::string extra_;
  std::optional<double> narrow_ns_;
  std::string json_path_ = "-";
  bool exhaustive_ = false;
};

}  // namespace sweepgrid
