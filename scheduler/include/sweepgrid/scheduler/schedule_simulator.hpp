#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <sweepgrid/scheduler/work_graph.hpp>

namespace sweepgrid {

/// Who takes which task of a stage.
enum class SchedulePolicy {
  /// As the executor does it on oneTBB: the range of tasks, heaviest estimate first for thieves, is halved down to
  /// single tasks; a worker goes on with its latest half, a thief takes the largest half of a victim chosen at random.
  kWorkStealing,
  /// Every worker gets as many tasks, a range of their indices, before any runs.
  kStaticRanges,
  /// One queue for all, and the longest of the times that the tasks will really take first: what no scheduler can know.
  kLongestFirst,
};

/// What a machine charges for going parallel, in seconds. All are left out on one worker, which runs a plain loop.
struct ScheduleCosts {
  double spawn = 0;    ///< to make and start a task, for each
  double steal = 0;    ///< from work being there until a worker that looks for it begins with it
  double wake = 0;     ///< until a sleeping worker looks; woken ones wake others, so the k-th of them takes
                       ///< floor(log2(k)) + 1 times as long
  double spin = 0;     ///< a worker that has looked in vain for longer sleeps. All but the caller sleep at first
  double barrier = 0;  ///< from the end of a stage's last task to its successor's start, for each doubling of workers
  /// Tasks bound by memory alone that can run at once at full speed, at least 1. When those that run ask for more, the
  /// parts of them that are bound by memory take proportionally longer.
  double memory_roof = std::numeric_limits<double>::infinity();
};

/// A task, or the serial part of a stage, on a worker.
struct ScheduledTask {
  static constexpr std::uint32_t kSerialPart = ~std::uint32_t{0};

  std::uint32_t stage = 0;
  std::uint32_t task = 0;  ///< index in its stage, or kSerialPart
  std::uint32_t worker = 0;
  double start = 0;     ///< seconds
  double duration = 0;  ///< its spawn, and what waiting for memory adds, included
};

struct Schedule {
  struct StageSpan {
    double start = 0;  ///< of its serial part
    double end = 0;
  };

  double makespan = 0;
  std::vector<StageSpan> stages;
  std::vector<double> busy;          ///< by worker
  std::vector<ScheduledTask> tasks;  ///< by start
  std::uint64_t steals = 0;          ///< ranges taken from another worker
};

/// Replays `graph` on `workers` workers: a discrete-event simulation, deterministic, O(events * workers).
///
/// What it does not know: caches, and what they gain or lose by where tasks run; other programs; that workers may be of
/// different speed; that thieves hinder each other. Times are those recorded, however many workers there are.
/// Throws std::invalid_argument as work_and_span() does, or when `workers` is below 1, a cost is negative or NaN, or
/// the memory roof is below 1.
[[nodiscard]] Schedule simulate(const WorkGraph& graph, int workers, SchedulePolicy policy, const ScheduleCosts& costs);

}  // namespace sweepgrid
