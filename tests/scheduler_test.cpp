#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <sweepgrid/scheduler/executor.hpp>
#include <sweepgrid/scheduler/host_arena.hpp>
#include <sweepgrid/scheduler/stage_graph.hpp>

namespace sweepgrid::scheduler_test {
namespace {

using StageId = StageGraph::StageId;
using Costs = std::vector<std::uint64_t>;

StageGraph::Plan equal_tasks(std::size_t count) {
  return [count](Costs& costs) { costs.assign(count, 1); };
}

/// Waits until `count` bodies of one for_each are inside at the same time, for ever where they cannot be. True when
/// each was on a worker of its own.
bool runs_together(Executor& executor, int count) {
  std::atomic<int> arrived = 0;
  std::vector<std::atomic<int>> bodies_of_worker(static_cast<std::size_t>(executor.concurrency()));
  executor.for_each(static_cast<std::size_t>(count), [&](std::size_t) {
    ++bodies_of_worker.at(static_cast<std::size_t>(executor.worker()));
    ++arrived;
    while (arrived.load() < count) std::this_thread::yield();
  });
  return std::all_of(bodies_of_worker.begin(), bodies_of_worker.end(), [](const auto& bodies) { return bodies <= 1; });
}

class SchedulerThreads : public testing::TestWithParam<int> {
 protected:
  std::shared_ptr<Executor> executor_ = make_executor(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Threads, SchedulerThreads, testing::Values(1, 2, 3, 8),
                         [](const auto& test) { return std::to_string(test.param); });

TEST_P(SchedulerThreads, HaveTheConcurrencyThatWasAskedFor) { EXPECT_EQ(executor_->concurrency(), GetParam()); }

TEST_P(SchedulerThreads, ForEachRunsEveryIndexOnce) {
  for (const std::size_t count : {0, 1, 2, 3, 7, 64, 1000}) {
    std::vector<std::atomic<int>> runs(count);
    executor_->for_each(count, [&](std::size_t i) { ++runs[i]; });
    for (std::size_t i = 0; i != count; ++i) ASSERT_EQ(runs[i], 1) << "index " << i << " of " << count;
  }
}

TEST_P(SchedulerThreads, ForEachNumbersItsWorkers) {
  std::atomic<bool> in_range = true;
  executor_->for_each(2000, [&](std::size_t) {
    const int worker = executor_->worker();
    if (worker < 0 || worker >= executor_->concurrency()) in_range = false;
  });
  EXPECT_TRUE(in_range);
}

TEST_P(SchedulerThreads, ForEachRethrows) {
  EXPECT_THROW(executor_->for_each(100,
                                   [](std::size_t i) {
                                     if (i == 50) throw std::runtime_error("fifty");
                                   }),
               std::runtime_error);
  EXPECT_THROW(executor_->execute([] { throw std::runtime_error("work"); }), std::runtime_error);
}

TEST_P(SchedulerThreads, AreReallyStarted) { EXPECT_TRUE(runs_together(*executor_, GetParam())); }

TEST_P(SchedulerThreads, StageGraphRunsEveryTaskOnce) {
  // Few tasks and many; costs in no order, with ties and zeros.
  for (const std::size_t count : {0, 1, 2, 5, 511, 512, 513, 5000}) {
    StageGraph graph(executor_);
    std::vector<std::atomic<int>> runs(count);
    graph.add(
        "only", {},
        [&](Costs& costs) {
          for (std::size_t i = 0; i != count; ++i) costs.push_back((i * 7919) % 37 * ((i * 31) % 5000));
        },
        [&](std::size_t task) { ++runs[task]; });
    for (int run = 1; run <= 3; ++run) {
      graph.run();
      for (std::size_t i = 0; i != count; ++i) ASSERT_EQ(runs[i], run) << "task " << i << " of " << count;
    }
  }
}

TEST_P(SchedulerThreads, StageGraphKeepsStagesInOrder) {
  StageGraph graph(executor_);
  std::atomic<int> clock = 0;
  std::vector<std::atomic<int>> first(5);
  std::vector<std::atomic<int>> last(5);
  std::vector<std::atomic<int>> planned(5);
  const std::vector<std::vector<StageId>> after = {{}, {}, {0, 1}, {0}, {2, 3}};
  for (std::size_t stage = 0; stage != after.size(); ++stage) {
    graph.add(
        "stage " + std::to_string(stage), after[stage],
        [&, stage](Costs& costs) {
          planned[stage] = ++clock;
          first[stage] = 1 << 30;
          last[stage] = planned[stage].load();
          costs.assign(40, stage + 1);
        },
        [&, stage](std::size_t) {
          const int begin = ++clock;
          for (int seen = first[stage]; begin < seen && !first[stage].compare_exchange_weak(seen, begin);) {
          }
          const int end = ++clock;
          for (int seen = last[stage]; end > seen && !last[stage].compare_exchange_weak(seen, end);) {
          }
        });
  }
  for (int run = 0; run != 20; ++run) {
    graph.run();
    for (std::size_t stage = 0; stage != after.size(); ++stage) {
      EXPECT_LT(planned[stage], first[stage]);
      for (const StageId earlier : after[stage]) EXPECT_LT(last[earlier], planned[stage]);
    }
  }
}

TEST_P(SchedulerThreads, StageGraphGivesPlansAnEmptyVector) {
  StageGraph graph(executor_);
  graph.add(
      "only", {}, [](Costs& costs) { costs.push_back(costs.size()); }, [](std::size_t) {});
  graph.record(true);
  for (int run = 0; run != 3; ++run) {
    graph.run();
    ASSERT_EQ(graph.trace().size(), 1U);
    EXPECT_EQ(graph.trace()[0].size, 0U);
  }
}

TEST_P(SchedulerThreads, StageGraphSkipsStagesAfterAnExceptionAndRunsAgain) {
  StageGraph graph(executor_);
  enum class Fails { kNot, kInPlan, kInTask } fails = Fails::kNot;
  std::atomic<int> later_runs = 0;
  const StageId first = graph.add(
      "first", {},
      [&](Costs& costs) {
        if (fails == Fails::kInPlan) throw std::runtime_error("plan");
        costs.assign(100, 1);
      },
      [&](std::size_t task) {
        if (fails == Fails::kInTask && task == 17) throw std::runtime_error("task");
      });
  graph.add("later", {first}, equal_tasks(10), [&](std::size_t) { ++later_runs; });

  for (int round = 0; round != 5; ++round) {
    for (const auto& [failing, message] : {std::pair(Fails::kInPlan, "plan"), std::pair(Fails::kInTask, "task")}) {
      fails = failing;
      try {
        graph.run();
        ADD_FAILURE() << "no exception";
      } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), message);
      }
      EXPECT_EQ(later_runs, 0);
    }
    fails = Fails::kNot;
    graph.run();
    EXPECT_EQ(later_runs.exchange(0), 10);
  }
}

TEST_P(SchedulerThreads, StageGraphRecordsEveryTaskInOrder) {
  StageGraph graph(executor_);
  const auto cost_of = [](std::size_t stage, std::size_t task) { return 1 + (task * 13 + stage) % 50; };
  for (std::size_t stage = 0; stage != 3; ++stage) {
    std::vector<StageId> after;
    if (stage > 0) after.push_back(static_cast<StageId>(stage - 1));
    graph.add(
        "stage", after,
        [=](Costs& costs) {
          for (std::size_t task = 0; task != 300 * stage; ++task) costs.push_back(cost_of(stage, task));
        },
        [](std::size_t) {});
  }
  graph.run();
  EXPECT_TRUE(graph.trace().empty());

  graph.record(true);
  graph.run();
  std::vector<std::tuple<std::size_t, std::size_t, std::uint64_t>> expected;
  for (std::size_t stage = 0; stage != 3; ++stage) {
    for (std::size_t task = 0; task != 300 * stage; ++task) expected.emplace_back(stage, task, cost_of(stage, task));
  }
  std::vector<std::tuple<std::size_t, std::size_t, std::uint64_t>> recorded;
  std::int64_t end_of_stage[3] = {};
  for (const TaskRecord& record : graph.trace()) {
    recorded.emplace_back(record.stage, record.task, record.size);
    EXPECT_GE(record.worker, 0);
    EXPECT_LT(record.worker, executor_->concurrency());
    EXPECT_GE(record.start_ns, record.stage == 0 ? 0 : end_of_stage[record.stage - 1]);
    EXPECT_GE(record.duration_ns, 0);
    end_of_stage[record.stage] = std::max(end_of_stage[record.stage], record.start_ns + record.duration_ns);
  }
  EXPECT_EQ(recorded, expected);
  for (StageId stage = 1; stage != 3; ++stage) EXPECT_GT(graph.seconds(stage), 0);
}

TEST_P(SchedulerThreads, ServeManyEnginesAtOnce) {
  constexpr int kEngines = 6;
  constexpr int kRuns = 50;
  std::vector<std::int64_t> sums(kEngines);
  {
    std::vector<std::jthread> callers;
    for (std::size_t engine = 0; engine != kEngines; ++engine) {
      callers.emplace_back([this, &sum = sums[engine]] {
        StageGraph graph(executor_);
        std::vector<std::int64_t> slots(64);
        const StageId fill =
            graph.add("fill", {}, equal_tasks(slots.size()), [&](std::size_t task) { slots[task] += 1; });
        graph.add("sum", {fill}, equal_tasks(1),
                  [&](std::size_t) { sum = std::accumulate(slots.begin(), slots.end(), std::int64_t{0}); });
        for (int run = 0; run != kRuns; ++run) graph.run();
      });
    }
  }
  for (const std::int64_t sum : sums) EXPECT_EQ(sum, 64 * kRuns);
}

TEST(Executor, RefusesNegativeThreads) { EXPECT_THROW(make_executor(-1), std::invalid_argument); }

TEST(Executor, ZeroThreadsMeansTheMachines) {
  EXPECT_EQ(make_executor(0)->concurrency(), static_cast<int>(std::thread::hardware_concurrency()));
}

TEST(Executor, SerialStaysOnTheCallingThread) {
  const auto executor = make_serial_executor();
  EXPECT_EQ(executor->concurrency(), 1);
  EXPECT_EQ(executor->worker(), 0);
  const std::thread::id caller = std::this_thread::get_id();
  executor->for_each(10, [&](std::size_t) { EXPECT_EQ(std::this_thread::get_id(), caller); });
}

TEST(Executor, OversubscribedOnesDoNotHoldEachOtherBack) {
  const auto small = make_executor(5);
  const auto large = make_executor(8);
  EXPECT_TRUE(runs_together(*large, 8));
  EXPECT_TRUE(runs_together(*small, 5));
}

TEST(HostArena, RunsInTheHostsArena) {
  // A size that no other arena of this program has.
  const oneapi::tbb::global_control allowed(oneapi::tbb::global_control::max_allowed_parallelism, 5);
  oneapi::tbb::task_arena arena(5);
  const auto executor = make_executor_in(arena);
  EXPECT_EQ(executor->concurrency(), 5);
  std::atomic<bool> inside = true;
  StageGraph graph(executor);
  graph.add("only", {}, equal_tasks(200), [&](std::size_t) {
    if (oneapi::tbb::this_task_arena::max_concurrency() != 5) inside = false;
  });
  graph.run();
  arena.execute([&] { graph.run(); });
  EXPECT_TRUE(inside);
}

TEST(HostArena, OfOneSlotNeedsNoWorker) {
  oneapi::tbb::task_arena arena(1);
  StageGraph graph(make_executor_in(arena));
  int runs = 0;
  const StageId first = graph.add("first", {}, equal_tasks(200), [&](std::size_t) { ++runs; });
  graph.add("second", {first}, equal_tasks(200), [&](std::size_t) { ++runs; });
  graph.run();
  EXPECT_EQ(runs, 400);
}

TEST(HostArena, CancelledByTheHostStillRunsEveryTask) {
  oneapi::tbb::task_arena arena(2);
  const auto executor = make_executor_in(arena);
  StageGraph graph(executor);
  std::atomic<int> runs = 0;
  graph.add("only", {}, equal_tasks(100), [&](std::size_t) { ++runs; });
  arena.execute([&] {
    oneapi::tbb::task_group host;
    host.run_and_wait([&] {
      host.cancel();
      graph.run();
      executor->for_each(100, [&](std::size_t) { ++runs; });
    });
  });
  EXPECT_EQ(runs, 200);
}

TEST(StageGraph, StartsTheHeaviestFirst) {
  for (const std::size_t count : {1, 2, 9, 511, 512, 3000}) {
    StageGraph graph(make_serial_executor());
    Costs planned;
    std::vector<std::size_t> started;
    graph.add(
        "only", {},
        [&](Costs& costs) {
          // The highest costs need all 64 bits.
          for (std::size_t i = 0; i != count; ++i) costs.push_back(((i * 7919) % 101) << (i % 3 == 0 ? 57 : 3));
          planned = costs;
        },
        [&](std::size_t task) { started.push_back(task); });
    graph.run();
    std::vector<std::size_t> expected(count);
    std::iota(expected.begin(), expected.end(), std::size_t{0});
    std::stable_sort(expected.begin(), expected.end(),
                     [&](std::size_t a, std::size_t b) { return planned[a] > planned[b]; });
    EXPECT_EQ(started, expected);
  }
}

TEST(StageGraph, GivesTheHeaviestToThoseWhoStealFirst) {
  // Two workers, each held in its first task until the other has one: they must be the two heaviest.
  StageGraph graph(make_executor(2));
  std::mutex mutex;
  std::vector<std::size_t> started;
  graph.add(
      "only", {},
      [](Costs& costs) {
        for (std::uint64_t i = 0; i != 9; ++i) costs.push_back(10 + (i * 5) % 9);
      },
      [&](std::size_t task) {
        std::unique_lock lock(mutex);
        started.push_back(task);
        while (started.size() < 2) {
          lock.unlock();
          std::this_thread::yield();
          lock.lock();
        }
      });
  graph.run();
  ASSERT_EQ(started.size(), 9U);
  EXPECT_EQ(std::set<std::size_t>(started.begin(), started.begin() + 2), (std::set<std::size_t>{7, 5}));
}

TEST(StageGraph, RefusesToWaitForAStageNotYetAdded) {
  StageGraph graph(make_serial_executor());
  EXPECT_THROW(graph.add("self", {0}, equal_tasks(1), [](std::size_t) {}), std::invalid_argument);
  EXPECT_EQ(graph.size(), 0U);
  EXPECT_EQ(graph.add("first", {}, equal_tasks(1), [](std::size_t) {}), 0U);
  EXPECT_EQ(graph.name(0), "first");
}

TEST(StageGraph, RefusesToLackAnExecutor) { EXPECT_THROW(StageGraph(nullptr), std::invalid_argument); }

TEST(StageGraph, WithoutStagesRunsNothing) {
  StageGraph(make_serial_executor()).run();
  StageGraph(make_executor(2)).run();
}

}  // namespace
}  // namespace sweepgrid::scheduler_test
