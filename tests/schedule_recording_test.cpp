#include <sweepgrid/scheduler/recording_executor.hpp>

#include <atomic>
#include <chrono>
#include <ctime>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <sweepgrid/scheduler/stage_graph.hpp>

namespace sweepgrid::schedule_recording_test {
namespace {

TEST(RecordingExecutor, RecordsLoopsInOrderUntilStopped) {
  for (const int threads : {1, 3}) {
    RecordingExecutor executor(make_executor(threads));
    EXPECT_EQ(executor.concurrency(), threads);
    executor.for_each(5, [](std::size_t) {});
    executor.start();
    std::atomic<int> runs = 0;
    executor.for_each(100, [&](std::size_t) { ++runs; });
    executor.for_each(0, [&](std::size_t) { ++runs; });
    executor.for_each(7, [&](std::size_t i) {
      if (i == 3) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    });
    const TaskTrace trace = executor.stop();
    executor.for_each(5, [](std::size_t) {});
    EXPECT_EQ(runs, 100);
    ASSERT_EQ(trace.size(), 107U);
    std::int64_t first_loop_end = 0;
    for (std::size_t i = 0; i < trace.size(); ++i) {
      const bool last_loop = i >= 100;
      EXPECT_EQ(trace[i].stage, last_loop ? 2U : 0U);
      EXPECT_EQ(trace[i].task, last_loop ? i - 100 : i);
      EXPECT_LT(trace[i].worker, threads);
      if (!last_loop) first_loop_end = std::max(first_loop_end, trace[i].start_ns + trace[i].duration_ns);
      EXPECT_GE(trace[i].start_ns, last_loop ? first_loop_end : 0);
    }
    EXPECT_GE(trace[103].duration_ns, 2'000'000);
    EXPECT_TRUE(executor.stop().empty());
  }
}

// Processor time of the calling thread.
std::int64_t thread_ns() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::int64_t{1'000'000'000} * time.tv_sec + time.tv_nsec;
}

// However slow the machine is, a task takes what the same clock tells inside of it, and all tasks together no more than
// what it tells outside.
TEST(RecordingExecutor, ByThreadStopwatchLeavesOutWhatOthersTake) {
  const auto executor = std::make_shared<RecordingExecutor>(make_serial_executor(), 4, RecordingClock::kThread);
  std::vector<std::int64_t> worked;
  const auto sleep_then_work = [&](std::size_t task) {
    if (task == 0) std::this_thread::sleep_for(std::chrono::milliseconds(200));
    if (task != 1) return;
    const std::int64_t start = thread_ns();
    while (thread_ns() - start < 10'000'000) {
    }
    worked.push_back(thread_ns() - start);
  };
  const std::int64_t start = thread_ns();
  executor->start();
  executor->for_each(2, sleep_then_work);
  TaskTrace loop = executor->stop();
  StageGraph graph(executor);
  graph.add(
      "only", {}, [](std::vector<std::uint64_t>& costs) { costs.assign(2, 1); }, sleep_then_work);
  graph.record(true);
  graph.run();
  std::int64_t rest = thread_ns() - start;
  const TaskTrace traces[] = {loop, graph.trace()};
  for (std::size_t t = 0; t < 2; ++t) {
    ASSERT_EQ(traces[t].size(), 2U);
    EXPECT_GE(traces[t][0].duration_ns, 0);
    EXPECT_GE(traces[t][1].duration_ns, worked.at(t));
    for (const TaskRecord& task : traces[t]) rest -= task.duration_ns;
  }
  EXPECT_GE(rest, 0);
}

TEST(RecordingExecutor, PassesForOneOfAnotherSize) {
  const auto executor = std::make_shared<RecordingExecutor>(make_serial_executor(), 64);
  EXPECT_EQ(executor->concurrency(), 64);
  StageGraph graph(executor);
  const std::thread::id caller = std::this_thread::get_id();
  int runs = 0;
  graph.add(
      "only", {}, [](std::vector<std::uint64_t>& costs) { costs.assign(200, 1); },
      [&](std::size_t) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        ++runs;
      });
  executor->start();
  graph.run();
  EXPECT_EQ(runs, 200);
  EXPECT_EQ(executor->stop().size(), 200U);
}

TEST(RecordingExecutor, LeavesStageGraphsOnTheirArena) {
  const auto executor = std::make_shared<RecordingExecutor>(make_executor(2));
  StageGraph graph(executor);
  // Each of the two waits for the other, so they must run at once: stages of one graph do so in a flow graph only.
  std::atomic<int> inside = 0;
  for (int i = 0; i < 2; ++i) {
    graph.add(
        "half", {}, [](std::vector<std::uint64_t>& costs) { costs.assign(1, 1); },
        [&](std::size_t) {
          ++inside;
          while (inside < 2) std::this_thread::yield();
        });
  }
  graph.run();
  EXPECT_EQ(inside, 2);
}

TEST(RecordingExecutor, RefusesNoExecutorAndNegativeSizes) {
  EXPECT_THROW(RecordingExecutor(nullptr), std::invalid_argument);
  EXPECT_THROW(RecordingExecutor(make_serial_executor(), -1), std::invalid_argument);
}

}  // namespace
}  // namespace sweepgrid::schedule_recording_test
