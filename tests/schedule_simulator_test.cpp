#include <sweepgrid/scheduler/schedule_simulator.hpp>

#include <algorithm>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace sweepgrid::schedule_simulator_test {
namespace {

constexpr SchedulePolicy kPolicies[] = {SchedulePolicy::kWorkStealing, SchedulePolicy::kStaticRanges,
                                        SchedulePolicy::kLongestFirst};
constexpr std::uint32_t kSerial = ScheduledTask::kSerialPart;
constexpr double kNear = 1e-9;

WorkStage stage(std::vector<std::uint32_t> after, double serial, const std::vector<double>& seconds) {
  WorkStage stage{"stage", std::move(after), serial, {}};
  for (const double task : seconds) stage.tasks.push_back({task, static_cast<std::uint64_t>(100 * task), 0});
  return stage;
}

/// Stages that wait for some of those before them, with tasks of times that differ a lot, estimated roughly.
WorkGraph random_graph(std::mt19937_64& random) {
  const auto below = [&](std::uint64_t bound) { return random() % bound; };
  WorkGraph graph;
  const std::size_t stages = 1 + below(6);
  for (std::uint32_t id = 0; id < stages; ++id) {
    WorkStage& added = graph.emplace_back();
    for (std::uint32_t earlier = 0; earlier < id; ++earlier) {
      if (below(2) == 0) added.after.push_back(earlier);
    }
    added.serial = static_cast<double>(below(20)) / 8;
    const std::size_t tasks = below(4) == 0 ? 0 : below(60);
    for (std::size_t i = 0; i < tasks; ++i) {
      const double seconds = static_cast<double>(below(below(2) == 0 ? 10 : 200)) / 8;
      added.tasks.push_back(
          {seconds, static_cast<std::uint64_t>(8 * seconds) + below(8), static_cast<double>(below(5)) / 4});
    }
  }
  return graph;
}

ScheduleCosts random_costs(std::mt19937_64& random) {
  const auto cost = [&] { return static_cast<double>(random() % 8) / 32; };
  return {cost(), cost(), cost(), cost(), cost(), 1 + static_cast<double>(random() % 8)};
}

/// What every schedule must be, whatever it costs.
void expect_possible(const WorkGraph& graph, const Schedule& schedule, int workers) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> runs;
  std::vector<double> free_at(static_cast<std::size_t>(workers), 0);
  std::vector<double> busy(static_cast<std::size_t>(workers), 0);
  std::vector<double> serial_end(graph.size(), 0);
  double end = 0;
  for (const ScheduledTask& task : schedule.tasks) {
    ++runs[{task.stage, task.task}];
    ASSERT_LT(task.worker, free_at.size());
    EXPECT_GE(task.start, free_at[task.worker] - kNear) << "two tasks at once on a worker";
    free_at[task.worker] = task.start + task.duration;
    busy[task.worker] += task.duration;
    end = std::max(end, task.start + task.duration);
    const WorkStage& stage = graph[task.stage];
    const double alone = task.task == kSerial ? stage.serial : stage.tasks[task.task].seconds;
    EXPECT_GE(task.duration, alone - kNear);
    if (task.task == kSerial) {
      serial_end[task.stage] = task.start + task.duration;
      for (const std::uint32_t earlier : stage.after) EXPECT_GE(task.start, schedule.stages[earlier].end - kNear);
    } else {
      EXPECT_GE(task.start, serial_end[task.stage] - kNear) << "before the plan";
    }
    EXPECT_LE(task.start + task.duration, schedule.stages[task.stage].end + kNear);
  }
  std::size_t tasks = 0;
  for (const WorkStage& stage : graph) tasks += stage.tasks.size() + 1;
  EXPECT_EQ(schedule.tasks.size(), tasks);
  EXPECT_EQ(runs.size(), tasks) << "a task twice";
  EXPECT_NEAR(schedule.makespan, end, kNear);
  for (std::size_t w = 0; w < busy.size(); ++w) EXPECT_NEAR(schedule.busy[w], busy[w], kNear);
}

TEST(WorkAndSpan, AddsUpAndFindsTheCriticalPath) {
  // 0 and 1 side by side, 2 after both, 3 after 0 alone.
  const WorkGraph graph = {stage({}, 1, {4, 2}), stage({}, 2, {1, 1, 1}), stage({0, 1}, 0.5, {3}),
                           stage({0}, 0.25, {})};
  const WorkAndSpan found = work_and_span(graph);
  EXPECT_DOUBLE_EQ(found.work, 1 + 6 + 2 + 3 + 0.5 + 3 + 0.25);
  EXPECT_DOUBLE_EQ(found.span, 1 + 4 + 0.5 + 3);
  EXPECT_DOUBLE_EQ(found.serial, 3.75);
  EXPECT_DOUBLE_EQ(found.serial_share(), 3.75 / 15.75);
  EXPECT_EQ(work_and_span({}).serial_share(), 0);
}

TEST(ScheduleSimulator, StaticRangesByHand) {
  // Two workers, five tasks: 0 and 1 against 2, 3 and 4.
  const WorkGraph graph = {stage({}, 1, {5, 1, 1, 1, 1}), stage({0}, 2, {4, 1})};
  const Schedule schedule = simulate(graph, 2, SchedulePolicy::kStaticRanges, {});
  EXPECT_DOUBLE_EQ(schedule.stages[0].end, 1 + 6);
  EXPECT_DOUBLE_EQ(schedule.stages[1].start, 7);
  EXPECT_DOUBLE_EQ(schedule.makespan, 7 + 2 + 4);
  EXPECT_EQ(schedule.busy, (std::vector<double>{1 + 6 + 2 + 4, 3 + 1}));
  EXPECT_EQ(schedule.steals, 0U);
}

TEST(ScheduleSimulator, LongestFirstByHand) {
  // 5 | 4; 3 to the second, 3 to the first, 3 to the second: 8 and 10, though 9 is possible.
  const Schedule schedule = simulate({stage({}, 0, {3, 4, 3, 5, 3})}, 2, SchedulePolicy::kLongestFirst, {});
  EXPECT_DOUBLE_EQ(schedule.makespan, 10);
  EXPECT_EQ(schedule.busy, (std::vector<double>{8, 10}));
}

TEST(ScheduleSimulator, WorkStealingByHand) {
  // Places by halves: the heaviest (5) stays in front, the next (4) opens the half that is stolen.
  const WorkGraph graph = {stage({}, 0, {1, 5, 2, 4})};
  const Schedule schedule = simulate(graph, 2, SchedulePolicy::kWorkStealing, {});
  ASSERT_EQ(schedule.tasks.size(), 5U);
  std::map<std::uint32_t, std::uint32_t> first;  // task by worker
  for (const ScheduledTask& task : schedule.tasks) {
    if (task.task != kSerial) first.try_emplace(task.worker, task.task);
  }
  EXPECT_EQ(first, (std::map<std::uint32_t, std::uint32_t>{{0, 1}, {1, 3}}));
  // The thief's half is 4 and 1, that of the first worker 5 and 2: nothing is left to be stolen again.
  EXPECT_DOUBLE_EQ(schedule.makespan, 7);
  EXPECT_EQ(schedule.steals, 1U);
}

TEST(ScheduleSimulator, ChargesForTasksStealsWakingAndBarriers) {
  const WorkGraph graph = {stage({}, 10, {100, 100}), stage({0}, 10, {100, 100})};
  ScheduleCosts costs;
  costs.spawn = 1;
  costs.steal = 2;
  costs.wake = 4;
  costs.spin = 50;
  costs.barrier = 8;
  const Schedule schedule = simulate(graph, 2, SchedulePolicy::kWorkStealing, costs);
  // The other worker sleeps at first: it begins at 10 + 4 + 2. After its task it has looked around since 117, when the
  // next stage has tasks at 117 + 8 + 10 it is awake.
  EXPECT_DOUBLE_EQ(schedule.stages[0].end, 10 + 4 + 2 + 1 + 100);
  EXPECT_DOUBLE_EQ(schedule.stages[1].start, 117 + 8);
  EXPECT_DOUBLE_EQ(schedule.makespan, 125 + 10 + 2 + 1 + 100);
  costs.spin = 5;
  EXPECT_DOUBLE_EQ(simulate(graph, 2, SchedulePolicy::kWorkStealing, costs).makespan, 125 + 10 + 4 + 2 + 1 + 100);
}

TEST(ScheduleSimulator, WokenWorkersWakeOthers) {
  ScheduleCosts costs;
  costs.wake = 1;
  const Schedule schedule =
      simulate({stage({}, 0, std::vector<double>(8, 100))}, 8, SchedulePolicy::kStaticRanges, costs);
  std::vector<double> starts;
  for (const ScheduledTask& task : schedule.tasks) {
    if (task.task != kSerial) starts.push_back(task.start);
  }
  EXPECT_EQ(starts, (std::vector<double>{0, 1, 2, 2, 3, 3, 3, 3}));
}

TEST(ScheduleSimulator, MemoryRoofSlowsDownWhatAsksForIt) {
  // Four tasks, half of each bound by memory, ask for 2; the roof is 1: their halves take twice as long. Then one is
  // left, and has the memory for itself.
  WorkGraph graph = {stage({}, 0, {2, 2, 2, 4})};
  for (WorkTask& task : graph[0].tasks) task.memory_share = 0.5;
  ScheduleCosts costs;
  costs.memory_roof = 1;
  const Schedule schedule = simulate(graph, 4, SchedulePolicy::kStaticRanges, costs);
  EXPECT_NEAR(schedule.tasks[1].duration, 3, kNear);
  EXPECT_NEAR(schedule.makespan, 3 + 2, kNear);
  costs.memory_roof = 2;
  EXPECT_NEAR(simulate(graph, 4, SchedulePolicy::kStaticRanges, costs).makespan, 4, kNear);
}

TEST(ScheduleSimulator, SideBySideStagesShareTheWorkers) {
  const WorkGraph graph = {stage({}, 0, {4, 4}), stage({}, 0, {4, 4}), stage({0, 1}, 1, {})};
  for (const SchedulePolicy policy : kPolicies)
    EXPECT_DOUBLE_EQ(simulate(graph, 4, policy, {}).makespan,
                     4 + 1 + (policy == SchedulePolicy::kStaticRanges ? 4 : 0));
}

TEST(ScheduleSimulator, RefusesWhatIsNoWorkAndNoMachine) {
  const auto run = [](const WorkGraph& graph, int workers, const ScheduleCosts& costs) {
    return simulate(graph, workers, SchedulePolicy::kWorkStealing, costs).makespan;
  };
  EXPECT_THROW(run({}, 0, {}), std::invalid_argument);
  EXPECT_THROW(run({stage({0}, 0, {})}, 1, {}), std::invalid_argument);
  EXPECT_THROW(run({stage({}, -1, {})}, 1, {}), std::invalid_argument);
  EXPECT_THROW(run({stage({}, 0, {std::numeric_limits<double>::infinity()})}, 1, {}), std::invalid_argument);
  WorkGraph graph = {stage({}, 0, {1})};
  graph[0].tasks[0].memory_share = 1.5;
  EXPECT_THROW(run(graph, 1, {}), std::invalid_argument);
  ScheduleCosts costs;
  costs.steal = -1;
  EXPECT_THROW(run({}, 1, costs), std::invalid_argument);
  costs = {};
  costs.memory_roof = 0.5;
  EXPECT_THROW(run({}, 1, costs), std::invalid_argument);
  EXPECT_EQ(run({}, 3, {}), 0);
}

/// Over random graphs.
class ScheduleProperties : public testing::TestWithParam<SchedulePolicy> {
 protected:
  template <class Check>
  void for_random_graphs(Check&& check) {
    for (std::uint64_t seed = 0; seed < 300 && !HasFailure(); ++seed) {
      SCOPED_TRACE(seed);
      std::mt19937_64 random(seed);
      const WorkGraph graph = random_graph(random);
      const ScheduleCosts costs = random_costs(random);
      const int workers = 1 + static_cast<int>(random() % (seed % 3 == 0 ? 100 : 6));
      check(graph, costs, workers);
    }
  }
};

TEST_P(ScheduleProperties, RunsEveryTaskOnceAndInTime) {
  for_random_graphs([](const WorkGraph& graph, const ScheduleCosts& costs, int workers) {
    expect_possible(graph, simulate(graph, workers, GetParam(), costs), workers);
  });
}

TEST_P(ScheduleProperties, IsNeverFasterThanWorkAndSpanAllow) {
  for_random_graphs([](const WorkGraph& graph, const ScheduleCosts& costs, int workers) {
    const WorkAndSpan bound = work_and_span(graph);
    for (const ScheduleCosts& charged : {costs, ScheduleCosts{}}) {
      const double makespan = simulate(graph, workers, GetParam(), charged).makespan;
      EXPECT_GE(makespan, std::max(bound.work / workers, bound.span) - kNear);
    }
  });
}

// Static ranges are not among them: they leave workers idle.
class GreedySchedules : public ScheduleProperties {};
TEST_P(GreedySchedules, WithoutCostsIsWithinGrahamsBound) {
  for_random_graphs([](const WorkGraph& graph, const ScheduleCosts&, int workers) {
    const WorkAndSpan bound = work_and_span(graph);
    const double makespan = simulate(graph, workers, GetParam(), {}).makespan;
    EXPECT_LE(makespan, bound.work / workers + (1 - 1.0 / workers) * bound.span + kNear);
    EXPECT_LE(makespan, (2 - 1.0 / workers) * std::max(bound.work / workers, bound.span) + kNear);
  });
}

TEST_P(ScheduleProperties, OneWorkerTakesTheSum) {
  for_random_graphs([](const WorkGraph& graph, const ScheduleCosts& costs, int) {
    EXPECT_NEAR(simulate(graph, 1, GetParam(), costs).makespan, work_and_span(graph).work, kNear);
  });
}

TEST_P(ScheduleProperties, IsTheSameEveryTime) {
  for_random_graphs([](const WorkGraph& graph, const ScheduleCosts& costs, int workers) {
    const auto flat = [&] {
      std::vector<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, double, double>> tasks;
      for (const ScheduledTask& task : simulate(graph, workers, GetParam(), costs).tasks) {
        tasks.emplace_back(task.stage, task.task, task.worker, task.start, task.duration);
      }
      return tasks;
    };
    EXPECT_EQ(flat(), flat());
  });
}

TEST_P(ScheduleProperties, ScalesWithItsTimes) {
  for_random_graphs([](WorkGraph graph, ScheduleCosts costs, int workers) {
    const double once = simulate(graph, workers, GetParam(), costs).makespan;
    for (WorkStage& stage : graph) {
      stage.serial *= 2;
      for (WorkTask& task : stage.tasks) task.seconds *= 2;
    }
    for (double* const cost : {&costs.spawn, &costs.steal, &costs.wake, &costs.spin, &costs.barrier}) *cost *= 2;
    EXPECT_NEAR(simulate(graph, workers, GetParam(), costs).makespan, 2 * once, kNear);
  });
}

// Without anything that an earlier end can turn into a later one (Graham's anomalies): stages side by side, workers
// that are still awake, or on their way, for the next stage.
TEST_P(ScheduleProperties, DearerMachinesAreNotFaster) {
  for_random_graphs([](WorkGraph graph, ScheduleCosts costs, int workers) {
    double longest = 0;
    for (std::uint32_t id = 0; id < graph.size(); ++id) {
      graph[id].after.clear();
      if (id > 0) graph[id].after.push_back(id - 1);
      for (WorkTask& task : graph[id].tasks) {
        task.memory_share = 0;
        longest = std::max(longest, task.seconds);
      }
    }
    costs.spin = std::numeric_limits<double>::infinity();
    const auto expect_not_faster = [&](double& cost) {
      // Whom a thief meets depends on when it looks, so a stage may gain a task by luck; nothing else may be gained.
      const bool lucky = GetParam() == SchedulePolicy::kWorkStealing;
      const double slack = kNear + (lucky ? static_cast<double>(graph.size()) * longest : 0);
      const double cheap = simulate(graph, workers, GetParam(), costs).makespan;
      const double before = std::exchange(cost, cost + 1);
      EXPECT_GE(simulate(graph, workers, GetParam(), costs).makespan, cheap - slack);
      cost = before;
    };
    for (double* const cost : {&costs.spawn, &costs.steal, &costs.barrier}) expect_not_faster(*cost);
    graph.resize(1);
    costs.spin = 0;
    expect_not_faster(costs.wake);
  });
}

std::string policy_name(const testing::TestParamInfo<SchedulePolicy>& policy) {
  switch (policy.param) {
    case SchedulePolicy::kWorkStealing:
      return "WorkStealing";
    case SchedulePolicy::kStaticRanges:
      return "StaticRanges";
    default:
      return "LongestFirst";
  }
}

INSTANTIATE_TEST_SUITE_P(Policies, ScheduleProperties, testing::ValuesIn(kPolicies), policy_name);
INSTANTIATE_TEST_SUITE_P(Policies, GreedySchedules,
                         testing::Values(SchedulePolicy::kWorkStealing, SchedulePolicy::kLongestFirst), policy_name);

}  // namespace
}  // namespace sweepgrid::schedule_simulator_test
