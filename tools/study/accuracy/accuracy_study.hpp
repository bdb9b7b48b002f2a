#pragma once

#include <optional>
#include <string>
#include <vector>

#include "study/accuracy/scene_result.hpp"
#include "study/report.hpp"
#include "study/study_options.hpp"

namespace sweepgrid::study {

struct AccuracyOptions {
  StudyOptions study;
  std::vector<std::string> scenes;    ///< as open_scene() takes them; empty: default_accuracy_scenes()
  std::optional<double> narrow_cost;  ///< ns per candidate pair, not negative; absent: measured
};

/// Of the paper, fast, far from the origin, at rest, turning: generated, of the given size.
[[nodiscard]] std::vector<std::string> default_accuracy_scenes(const AccuracySize& size);

/// The speed-accuracy charts. `narrow_source`: where the price of the narrow phase is from.
[[nodiscard]] Report accuracy_report(const AccuracyOptions& options, const std::vector<SceneResult>& results,
                                     double narrow_ns, const std::string& narrow_source);

/// Plays every configuration in every scene and writes the report "accuracy" into the folder. False when one did not
/// keep what it promises, which is told on stderr, too. Throws std::invalid_argument for a price or a scene given
/// twice, what know_scene() throws, Interrupted, and std::exception for a folder that cannot be written into.
[[nodiscard]] bool accuracy_study(const AccuracyOptions& options);

/// The same with scenes of the caller's size.
[[nodiscard]] bool accuracy_study(const AccuracyOptions& options, const AccuracySize& size);

}  // namespace sweepgrid::study
