#include "study/study_progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "cli/standard_streams.hpp"

namespace sweepgrid::study {
namespace {

constexpr std::size_t kWidth = 30;
constexpr std::chrono::seconds kPause(10);  // between two lines of a log

}  // namespace

StudyProgress::StudyProgress(std::string title, std::size_t points, double cost)
    : title_(std::move(title)), points_(points), cost_left_(cost), on_terminal_(isatty(STDERR_FILENO) == 1) {}

StudyProgress::~StudyProgress() {
  if (on_terminal_) show_on_stderr("\r\x1b[K");
}

void StudyProgress::begin(const std::string& point) { show(point); }

void StudyProgress::end(double cost, double seconds) {
  cost_measured_ += cost;
  seconds_measured_ += seconds;
  skip(cost);
}

void StudyProgress::skip(double cost) {
  ++done_;
  cost_left_ = std::max(0.0, cost_left_ - cost);
}

double StudyProgress::remaining() const {
  return cost_measured_ > 0 ? cost_left_ * seconds_measured_ / cost_measured_ : cost_left_;
}

void StudyProgress::show(const std::string& point) {
  const auto now = std::chrono::steady_clock::now();
  const std::string left = duration_text(remaining());
  if (on_terminal_) {
    const std::string bar(points_ == 0 ? kWidth : kWidth * done_ / points_, '#');
    show_on_stderr(
        fmt::format("\r\x1b[K{} [{:.<{}}] {}/{}, about {} left: {}", title_, bar, kWidth, done_, points_, left, point));
    std::fflush(stderr);
  } else if (now - last_shown_ >= kPause) {
    show_on_stderr(fmt::format("{}: {} of {} points, about {} left; next: {}\n", title_, done_, points_, left, point));
    last_shown_ = now;
  }
}

std::string duration_text(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

}  // namespace sweepgrid::study
