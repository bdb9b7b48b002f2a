#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace sweepgrid {

/// How far a scene has come, on the standard error and only if that is a terminal.
class ProgressBar {
 public:
  /// `total`: steps, if known.
  ProgressBar(std::string title, std::optional<std::uint64_t> total);
  /// Takes the bar away.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(std::uint64_t done);

 private:
  std::string title_;
  std::optional<std::uint64_t> total_;
  bool on_terminal_;
  std::chrono::steady_clock::time_point last_shown_;
};

}  // namespace sweepgrid
