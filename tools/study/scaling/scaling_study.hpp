#pragma once

#include <string>
#include <vector>

#include "study/study_options.hpp"

namespace sweepgrid::study {

/// What `sweepgrid study scaling` was asked for.
struct ScalingOptions {
  StudyOptions study;
  std::vector<std::string> scenes;  ///< empty: scaling_scenes()
  std::vector<int> threads;         ///< measured; empty: 1, 2, 4, ... and as many as the machine has
  std::vector<int> simulate;        ///< workers; empty: 1, 2, 4, ..., 256
  bool weak = false;                ///< also with objects that grow with the threads
  std::string trace;                ///< file for the tasks of a step in the Trace Event format; empty: none
};

/// What is taken when no scene is named.
[[nodiscard]] std::vector<std::string> scaling_scenes();

/// Measures and predicts how steps scale with threads, and writes the report "scaling" into the folder. False when
/// events differ from one thread count to another or pairs are not the oracle's: the report says where.
/// Throws Interrupted, and std::exception for bad scenes, for --weak with a recording, for more threads than the
/// machine has, and for a folder or file that cannot be written.
[[nodiscard]] bool scaling_study(const ScalingOptions& options);

}  // namespace sweepgrid::study
