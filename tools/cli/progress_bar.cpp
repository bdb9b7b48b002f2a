#include "cli/progress_bar.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "cli/standard_streams.hpp"

namespace sweepgrid {
namespace {

constexpr std::size_t kWidth = 30;
constexpr std::chrono::milliseconds kPause(100);

}  // namespace

ProgressBar::ProgressBar(std::string title, std::optional<std::uint64_t> total)
    : title_(std::move(title)), total_(total), on_terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (on_terminal_) show_on_stderr("\r\x1b[K");
}

void ProgressBar::show(std::uint64_t done) {
  if (!on_terminal_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_shown_ < kPause) return;
  last_shown_ = now;
  if (!total_ || *total_ == 0) {
    show_on_stderr(fmt::format("\r\x1b[K{} step {}", title_, done));
  } else {
    const double part = static_cast<double>(std::min(done, *total_)) / static_cast<double>(*total_);
    const std::string bar(static_cast<std::size_t>(part * kWidth), '#');
    show_on_stderr(fmt::format("\r\x1b[K{} [{:.<{}}] {}/{}", title_, bar, kWidth, done, *total_));
  }
  std::fflush(stderr);
}

}  // namespace sweepgrid
