#include <sweepgrid/scheduler/recording_executor.hpp>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace sweepgrid {

RecordingExecutor::RecordingExecutor(std::shared_ptr<Executor> runs_on, int workers, RecordingClock clock)
    : runs_on_(std::move(runs_on)), workers_(workers), clock_(clock) {
  if (runs_on_ == nullptr) throw std::invalid_argument("a recording executor needs an executor to run on");
  if (workers < 0) throw std::invalid_argument("workers must not be negative: " + std::to_string(workers));
  if (workers == 0) workers_ = runs_on_->concurrency();
  if (clock_ == RecordingClock::kWall) return;
  // Dearer than the wall clock by far: a call of the system, where that is a matter of reading a register.
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < 100; ++i) {
    const std::int64_t start = now();
    least = std::min(least, now() - start);
  }
  clock_cost_ = least;
}

std::int64_t RecordingExecutor::now() const {
  if (clock_ == RecordingClock::kThread) {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return std::int64_t{1'000'000'000} * time.tv_sec + time.tv_nsec;
  }
  const auto time = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time).count();
}

std::int64_t RecordingExecutor::since(std::int64_t start) const {
  return std::max<std::int64_t>(0, now() - start - clock_cost_);
}

void RecordingExecutor::for_each(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (!recording_) return runs_on_->for_each(count, body);
  const std::size_t first = trace_.size();
  trace_.resize(first + count);
  const std::uint32_t loop = loops_++;
  runs_on_->for_each(count, [&](std::size_t i) {
    const std::int64_t begin = now();
    body(i);
    trace_[first + i] = {loop, static_cast<std::uint32_t>(i), 0, runs_on_->worker(), begin - started_, since(begin)};
  });
}

void RecordingExecutor::start() {
  trace_.clear();
  loops_ = 0;
  recording_ = true;
  started_ = now();
}

TaskTrace RecordingExecutor::stop() {
  recording_ = false;
  return std::exchange(trace_, {});
}

}  // namespace sweepgrid
