#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "accuracy/accuracy_tally.hpp"
#include "accuracy/truth.hpp"
#include "study/accuracy/configurations.hpp"
#include "study/accuracy/known_scene.hpp"

namespace sweepgrid::study {

/// How scenes are played.
struct AccuracySize {
  std::uint64_t objects = 6000;         ///< of generated scenes where nothing else is asked for
  std::uint64_t steps = 32;             ///< of these
  std::uint64_t recorded_steps = 1000;  ///< of recordings and of scenes that were asked for, at most
  int rounds = 7;
  std::uint64_t most_pairs = 4000000;  ///< a configuration that reports more after a step is given up

  /// Of --quick, or in full.
  [[nodiscard]] static AccuracySize of(bool quick);
};

/// What became of a configuration in a scene.
struct ConfigurationResult {
  std::string name;
  std::string given_up;         ///< why it was; empty otherwise, and then the rest is there
  std::vector<double> step_ms;  ///< mean over the steps, by round
  std::uint64_t violations = 0;
  double candidates = 0;                       ///< pairs reported, mean over all steps
  std::vector<accuracy::Accuracy> accuracies;  ///< by truth, as of SceneResult::truths
};

/// What was measured of a scene.
struct SceneResult {
  std::string name;
  std::uint64_t objects = 0;
  std::uint64_t steps = 0;  ///< after the start
  double width = 0;
  std::vector<accuracy::TruthKind> truths;
  std::vector<ConfigurationResult> configurations;  ///< as of configurations()
};

/// "T0", "T1", "T2".
[[nodiscard]] std::string truth_name(accuracy::TruthKind kind);

/// Plays every configuration once beside the truths, and then all of them in turn for their times.
[[nodiscard]] SceneResult measure_scene(const KnownScene& scene, const AccuracySize& size);

/// For every promise that was not kept, a sentence that names scene, configuration and truth.
[[nodiscard]] std::vector<std::string> broken_promises(const SceneResult& result);

/// Every field by its name; and back. Throws nlohmann::json::exception for what is none.
[[nodiscard]] nlohmann::json scene_result_json(const SceneResult& result);
[[nodiscard]] SceneResult scene_result_of(const nlohmann::json& json);

}  // namespace sweepgrid::study
