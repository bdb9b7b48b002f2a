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

namespace sweepgrid {
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

TEST(RecordingExecutor, ByThreadStopwatchLeavesOutWhatOthersTake) {
  const auto executor = std::make_shared<RecordingExecutor>(make_serial_executor(), 4, RecordingClock::kThread);
  const auto sleep_then_work = [](std::size_t task) {
    if (task == 0) std::this_thread::sleep_for(std::chrono::milliseconds(200));
    if (task == 1) {
      const std::clock_t start = std::clock();
      while (std::clock() - start < CLOCKS_PER_SEC / 100) {
      }
    }
  };
  executor->start();
  executor->for_each(2, sleep_then_work);
  TaskTrace loop = executor->stop();
  StageGraph graph(executor);
  graph.add(
      "only", {}, [](std::vector<std::uint64_t>& costs) { costs.assign(2, 1); }, sleep_then_work);
  graph.record(true);
  graph.run();
  for (const TaskTrace& trace : {loop, graph.trace()}) {
    ASSERT_EQ(trace.size(), 2U);
    EXPECT_LT(trace[0].duration_ns, 100'000'000);
    EXPECT_GE(trace[0].duration_ns, 0);
    EXPECT_GE(trace[1].duration_ns, 5'000'000);
  }
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
          const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
          while (inside < 2 && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
          EXPECT_EQ(inside, 2);
        });
  }
  graph.run();
}

TEST(RecordingExecutor, RefusesNoExecutorAndNegativeSizes) {
  EXPECT_THROW(RecordingExecutor(nullptr), std::invalid_argument);
  EXPECT_THROW(RecordingExecutor(make_serial_executor(), -1), std::invalid_argument);
}

}  // namespace
}  // namespace sweepgrid
