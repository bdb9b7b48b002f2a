#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "study/point_store.hpp"
#include "study/scaling/prediction.hpp"
#include "study/scaling/run.hpp"
#include "study/scaling/scaling_study.hpp"
#include "study/study_points.hpp"

namespace sweepgrid::study {

/// How much of everything a scaling study does.
struct ScalingPlan {
  std::vector<std::string> scenes;
  std::vector<int> threads;                           ///< ascending, 1 among them
  std::vector<int> simulate;                          ///< ascending, 1 among them
  std::vector<int> populations = {4, 8, 16, 32, 64};  ///< what-if: objects per cell
  int what_if_workers = 64;
  bool weak = false;
  std::uint64_t steps = 10;                ///< of a scene
  int rounds = 7;                          ///< of measured runs
  int runs = 4;                            ///< of recorded ones
  std::uint64_t weak_objects = 2'000'000;  ///< most that are simulated

  /// Throws std::invalid_argument for threads that the machine does not have, SceneError for --weak with a recording.
  [[nodiscard]] static ScalingPlan of(const ScalingOptions& options);
  /// By how many a generated scene grows: all threads, and of the simulated workers those for which it stays small.
  [[nodiscard]] std::vector<int> weak_workers(const std::string& scene) const;
  /// All that shapes a point but what its key tells.
  [[nodiscard]] nlohmann::json parameters() const;
};

/// Keys of the points.
namespace scaling_key {
inline const std::string kCosts = "machine costs";
[[nodiscard]] std::string memory(const std::string& scene);
[[nodiscard]] std::string measured(const std::string& scene);
[[nodiscard]] std::string checked(const std::string& scene);
[[nodiscard]] std::string predicted(const std::string& scene, int workers);
[[nodiscard]] std::string population(const std::string& scene, int population);
[[nodiscard]] std::string cut(const std::string& scene);
[[nodiscard]] std::string timeline(const std::string& scene);
[[nodiscard]] std::string weak(const std::string& scene, int workers);
}  // namespace scaling_key

/// Measures the points of a study, and keeps the scene at hand.
class ScalingBench {
 public:
  /// `store` must outlive it: what costs and memory shares were found is taken from there.
  ScalingBench(ScalingPlan plan, const PointStore& store) : plan_(std::move(plan)), store_(store) {}

  /// In the order in which they need each other. They refer to this object.
  [[nodiscard]] std::vector<StudyPoint> points();

  /// The step of `scene` from which timelines are made, cut for `workers`, and its schedule.
  struct Timed {
    WorkGraph work;
    Schedule schedule;
  };
  [[nodiscard]] Timed timed_step(const std::string& scene, int workers);
  [[nodiscard]] const SceneScript& scene(const std::string& name);

 private:
  [[nodiscard]] nlohmann::json memory_shares(const std::string& scene);
  [[nodiscard]] nlohmann::json measured(const std::string& scene);
  [[nodiscard]] nlohmann::json checked(const std::string& scene);
  [[nodiscard]] nlohmann::json predicted(const std::string& scene, int workers, const ScalingSettings& settings);
  [[nodiscard]] nlohmann::json cut(const std::string& scene);
  [[nodiscard]] nlohmann::json timeline(const std::string& scene);
  [[nodiscard]] nlohmann::json weak(const std::string& scene, int workers);
  [[nodiscard]] MachineCosts costs() const;
  [[nodiscard]] MemoryShares shares(const std::string& scene) const;

  ScalingPlan plan_;
  const PointStore& store_;
  SceneScript scene_;
};

}  // namespace sweepgrid::study
