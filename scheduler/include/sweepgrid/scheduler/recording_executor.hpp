#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

#include <sweepgrid/scheduler/executor.hpp>
#include <sweepgrid/scheduler/task_trace.hpp>

namespace sweepgrid {

/// By which clock tasks are recorded.
enum class RecordingClock {
  kWall,
  /// Processor time of the thread, without what reading it costs: free of what other programs take. Only for executors
  /// on which the calling thread does all.
  kThread,
};

/// Runs on another executor and records the loops that come through it: those of bulk calls, which no stage graph
/// records. It can also pass for an executor of another size. On the serial executor, one thread then does the work of
/// any number of workers, cut as it would be for them and free of whatever many threads do to each other on few cores.
class RecordingExecutor final : public Executor {
 public:
  /// `workers`: what concurrency() tells; 0: as `runs_on` does. Throws std::invalid_argument when `runs_on` is null or
  /// `workers` is negative. Stage graphs on this executor record by its clock, too.
  explicit RecordingExecutor(std::shared_ptr<Executor> runs_on, int workers = 0,
                             RecordingClock clock = RecordingClock::kWall);

  [[nodiscard]] int concurrency() const override { return workers_; }
  [[nodiscard]] int worker() const override { return runs_on_->worker(); }
  void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override;
  void execute(const std::function<void()>& work) override { runs_on_->execute(work); }

  /// From now on every call of for_each() is recorded, until stop(): one loop after another. Not thread-safe.
  void start();
  /// What was recorded since start(). The calls of for_each() count as stages; their tasks have the size 0.
  [[nodiscard]] TaskTrace stop();

  [[nodiscard]] Executor& runs_on() const { return *runs_on_; }

  /// Time of the clock, in nanoseconds from no particular moment.
  [[nodiscard]] std::int64_t now() const;
  /// From `start` to now, less what reading the clock costs.
  [[nodiscard]] std::int64_t since(std::int64_t start) const;

 private:
  std::shared_ptr<Executor> runs_on_;
  int workers_;
  RecordingClock clock_;
  std::int64_t clock_cost_ = 0;
  bool recording_ = false;
  std::uint32_t loops_ = 0;
  std::int64_t started_ = 0;
  TaskTrace trace_;
};

}  // namespace sweepgrid
