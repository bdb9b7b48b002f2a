#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "study/machine_costs.hpp"
#include "study/point_store.hpp"
#include "study/scaling/points.hpp"
#include "study/scaling/prediction.hpp"

namespace sweepgrid::study {

/// Steps that were measured with one number of threads, and what was predicted for them.
struct MeasuredThreads {
  int threads = 1;
  double seconds = 0;                     ///< of all steps, by the least times of their parts
  std::vector<double> round_seconds;      ///< as they were, by round
  std::vector<double> part_seconds;       ///< queueing, stages, the rest of step()
  std::vector<std::vector<double>> busy;  ///< by stage and worker
  bool same_events = true;                ///< in all rounds, as in the run that was checked
  Prediction predicted;                   ///< cut for as many workers, recorded on one thread
  Prediction replayed;                    ///< the tasks with the times that they took on these threads

  /// On this machine's memory.
  [[nodiscard]] double predicted_seconds() const { return predicted.seconds("stealing_roof"); }
  [[nodiscard]] double error() const { return predicted_seconds() / seconds - 1; }
  [[nodiscard]] double replay_error() const { return replayed.seconds("stealing") / seconds - 1; }
  /// How many times as long the tasks take on these threads as on one.
  [[nodiscard]] double task_slowdown() const { return replayed.work / predicted.work; }
  /// Mean over most of the workers' times in tasks, weighted by stage: 1 when all have as much to do in each.
  [[nodiscard]] double balance() const;
};

struct WhatIf {
  std::string what;  ///< "population", "grain" or "shards"
  double value = 0;
  Prediction predicted;
};

struct WeakFindings {
  int workers = 1;
  std::uint64_t objects = 0;
  double measured_seconds = 0;  ///< 0: not measured
  Prediction predicted;
};

struct TimelineFindings {
  std::size_t workers = 0;
  std::vector<std::string> stages;
  struct Task {
    std::size_t worker = 0;
    std::size_t stage = 0;
    int task = 0;  ///< -1: the serial part
    double start = 0;
    double duration = 0;
  };
  std::vector<Task> tasks;
};

/// The points of one scene.
struct SceneFindings {
  std::string name;
  std::uint64_t objects = 0;
  std::size_t steps = 0;
  std::uint64_t events = 0;
  std::vector<std::string> stages;  ///< of step()
  std::vector<MeasuredThreads> measured;
  std::map<int, Prediction> predicted;  ///< by workers; 1 is among them
  MemoryShares memory;
  std::vector<WhatIf> what_ifs;
  int what_if_workers = 0;
  std::vector<WeakFindings> weak;
  TimelineFindings timeline;
  bool ok = true;  ///< the oracle agrees
  std::string error;
  std::uint64_t checksum = 0;
  std::uint64_t steps_checked = 0;
  std::uint64_t pairs_checked = 0;

  [[nodiscard]] bool exact() const;
  /// On so many workers, against one.
  [[nodiscard]] double predicted_speedup(int workers, const std::string& forecast) const;
};

/// All points of `plan` must be in `store`.
[[nodiscard]] std::vector<SceneFindings> scaling_findings(const ScalingPlan& plan, const PointStore& store);

}  // namespace sweepgrid::study
