#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pair_digest.hpp"
#include "scene_truth.hpp"
#include "system.hpp"

namespace sweepgrid::bench {

/// What one run of one system over a script gave. Times are in seconds.
struct Run {
  double first_insertion = 0;          ///< the whole first step
  double removal = 0;                  ///< of half of all objects, the whole step
  std::vector<double> whole_steps;     ///< the others: queueing and step()
  double step_only = 0;                ///< sum of step() over those
  std::uint64_t changes = 0;           ///< moved, inserted and erased objects in those
  std::uint64_t heap_bytes = 0;        ///< by which the heap has grown before the removal
  std::optional<std::uint64_t> bytes;  ///< then, by the system's own account
  std::uint32_t live = 0;              ///< objects then
  PairDigest pairs;                    ///< then
  std::optional<EventTotals> events;   ///< until then
  std::vector<std::string> complaints;

  [[nodiscard]] double ns_per_update() const;
  [[nodiscard]] double step_only_ns_per_update() const;
  [[nodiscard]] double p99_over_mean() const;
  [[nodiscard]] double max_over_median() const;
  /// By the system's own account where there is one.
  [[nodiscard]] double bytes_per_object() const;
  [[nodiscard]] double heap_bytes_per_object() const;
};

/// Makes a system, plays the script and then its removal, and checks the pairs wherever `truth` knows them, while no
/// clock runs.
[[nodiscard]] Run play(const SystemMaker& maker, const SceneScript& script, const SceneTruth& truth);

}  // namespace sweepgrid::bench
