#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "accuracy/guarded_run.hpp"
#include "accuracy/methods.hpp"
#include "accuracy/scene_pair.hpp"

namespace sweepgrid::accuracy {

/// A script with the pairs of T0 after each of its steps, in the boxes that the methods get. Updates to boxes that are
/// bad input have no part in it: their objects stay as they were.
struct KnownScript {
  SceneScript script;
  std::vector<std::vector<ScenePair>> pairs;  ///< by step
  std::uint64_t bad_boxes = 0;
};

/// Reads a scene that inserts good boxes only. Throws what open_scene() throws.
[[nodiscard]] KnownScript know_script(const std::string& scene, std::uint64_t steps);

/// What is to be said of a trial, the worst first.
enum class Verdict {
  kCrash,
  kError,  ///< an exception other than those below
  kOutOfMemory,
  kOutOfTime,
  kOverBudget,  ///< refused a step for want of memory, and was as before it
  kTakesBad,    ///< took a box with a NaN or min > max for good
  kMisses,      ///< did not tell of a pair
  kSuperset,    ///< told of pairs that are none
  kExact,
};

/// "crash", "error", "memory", "time", "budget", "bad", "misses", "superset", "exact".
[[nodiscard]] std::string verdict_name(Verdict verdict);

/// How a method did in a script. Counts are sums over the steps that it came to.
struct Trial {
  Verdict verdict = Verdict::kExact;
  std::string error;        ///< of a crash or an error: what it was
  std::uint64_t steps = 0;  ///< that it came to, after the start
  std::uint64_t true_pairs = 0;
  std::uint64_t reported_pairs = 0;
  std::uint64_t missed_pairs = 0;
  std::uint64_t extra_pairs = 0;
  std::uint64_t refused_boxes = 0;  ///< of the script's bad boxes
  double start_ms = 0;              ///< processor time of the first step
  double step_ms = 0;               ///< of the others: the median
  double most_step_ms = 0;
  std::uint64_t peak_bytes = 0;  ///< most resident memory of the process, the script included
};

/// Plays the script in a guarded process and compares the pairs of every step. The time of `budget` is that of the
/// method's own steps: a trial ends after the step that takes it over half of it, and tells what it came to; it counts
/// as out of time unless that was the last. The process, comparisons included, may take four times as long.
[[nodiscard]] Trial try_method(const Method& method, const KnownScript& known, const RunBudget& budget);

/// Every field by its name, the verdict by verdict_name(); and back.
[[nodiscard]] nlohmann::json trial_json(const Trial& trial);
[[nodiscard]] Trial trial_of(const nlohmann::json& json);

}  // namespace sweepgrid::accuracy
