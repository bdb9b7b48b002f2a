#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace sweepgrid::study {

/// How far a study has come, on the standard error: a bar where that is a terminal, else a line now and then.
class StudyProgress {
 public:
  /// `points`: in all. `cost`: the sum of what they are expected to cost, in any unit, such as seconds elsewhere.
  StudyProgress(std::string title, std::size_t points, double cost);
  /// Takes the bar away.
  ~StudyProgress();
  StudyProgress(const StudyProgress&) = delete;
  StudyProgress& operator=(const StudyProgress&) = delete;

  /// Tells what is measured next.
  void begin(const std::string& point);
  /// A point of expected cost `cost` is there: after `seconds` of measuring.
  void end(double cost, double seconds);
  /// A point was there already.
  void skip(double cost);

  /// Seconds until the end, by what the points so far took for their expected cost; the cost itself before the first.
  [[nodiscard]] double remaining() const;

 private:
  void show(const std::string& point);

  std::string title_;
  std::size_t points_;
  std::size_t done_ = 0;
  double cost_left_;
  double cost_measured_ = 0;
  double seconds_measured_ = 0;
  bool on_terminal_;
  std::chrono::steady_clock::time_point last_shown_;
};

/// "40 s", "3 min 20 s", "1 h 5 min".
[[nodiscard]] std::string duration_text(double seconds);

}  // namespace sweepgrid::study
