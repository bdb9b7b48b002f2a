#include <sweepgrid/scheduler/recording_executor.hpp>

#include <stdexcept>
#include <utility>

namespace sweepgrid {

RecordingExecutor::RecordingExecutor(std::shared_ptr<Executor> runs_on, int workers)
    : runs_on_(std::move(runs_on)), workers_(workers) {
  if (runs_on_ == nullptr) throw std::invalid_argument("a recording executor needs an executor to run on");
  if (workers < 0) throw std::invalid_argument("workers must not be negative: " + std::to_string(workers));
  if (workers == 0) workers_ = runs_on_->concurrency();
}

void RecordingExecutor::for_each(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (!recording_) return runs_on_->for_each(count, body);
  const std::uint32_t loop = loops_++;
  const std::size_t first = trace_.size();
  trace_.resize(first + count);
  const auto nanoseconds = [](Clock::duration duration) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
  };
  runs_on_->for_each(count, [&](std::size_t i) {
    const Clock::time_point begin = Clock::now();
    body(i);
    trace_[first + i] = {loop,
                         static_cast<std::uint32_t>(i),
                         0,
                         runs_on_->worker(),
                         nanoseconds(begin - started_),
                         nanoseconds(Clock::now() - begin)};
  });
}

void RecordingExecutor::start() {
  trace_.clear();
  loops_ = 0;
  recording_ = true;
  started_ = Clock::now();
}

TaskTrace RecordingExecutor::stop() {
  recording_ = false;
  return std::exchange(trace_, {});
}

}  // namespace sweepgrid
