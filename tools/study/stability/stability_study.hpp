#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "accuracy/method_trial.hpp"
#include "accuracy/methods.hpp"
#include "accuracy/regimes.hpp"
#include "study/report.hpp"
#include "study/study_options.hpp"

namespace sweepgrid::study {

/// How large the scenes of the stability map are, and what a method may use in each.
struct StabilitySize {
  std::uint64_t objects = 2000;
  std::uint64_t steps = 16;
  accuracy::RunBudget budget{std::uint64_t{2} << 30, 10};

  /// Numbers of objects for the growth of what is hardest, and the steps there.
  std::vector<std::uint64_t> growing = {500, 1000, 2000, 4000, 8000, 16000};
  std::uint64_t growing_steps = 4;

  /// Of --quick, or in full.
  [[nodiscard]] static StabilitySize of(bool quick);
};

/// accuracy::regimes() and accuracy::memory_regime().
[[nodiscard]] std::vector<accuracy::Regime> stability_regimes();

/// The trials of one scene, by method.
using SceneTrials = std::map<std::string, accuracy::Trial>;

/// What was measured: the calm scene, and every regime at each of its values, by "id=value".
struct StabilityResults {
  SceneTrials calm;
  std::map<std::string, SceneTrials> hard;
  /// By number of objects: calm_name() and growing_regimes() at their last values, for growing_methods().
  std::map<std::uint64_t, std::map<std::string, SceneTrials>> growing;
};

/// "calm", the name of the calm scene among others.
[[nodiscard]] std::string calm_name();
/// The regimes whose growth is measured, and the methods.
[[nodiscard]] std::vector<accuracy::Regime> growing_regimes();
[[nodiscard]] std::vector<accuracy::Method> growing_methods();
/// "id=value".
[[nodiscard]] std::string point_name(const accuracy::Regime& regime, const std::string& value);

/// A heat map for every regime, and a table that says for each method where it fails and how.
[[nodiscard]] Report stability_report(const StabilitySize& size, const StabilityResults& results, bool quick);

/// Tries every method in every regime and writes the report "stability" into the folder. False when the engine, with
/// any kind of cell, was not exact. Throws Interrupted, and std::exception for a folder that cannot be written into.
/// The process must not have run an engine on several threads.
[[nodiscard]] bool stability_study(const StudyOptions& options);

/// The same with scenes of the caller's size.
[[nodiscard]] bool stability_study(const StudyOptions& options, const StabilitySize& size);

}  // namespace sweepgrid::study
