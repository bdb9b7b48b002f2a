#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "cli/overlap_oracle.hpp"
#include "pair_digest.hpp"
#include "system.hpp"

namespace sweepgrid::bench {

/// Which pairs overlap after some of a script's steps, found from nothing but the boxes.
class SceneTruth {
 public:
  /// `script` must outlive this. O(n log n + n k) for every step that is looked at, k: boxes whose x extents meet.
  explicit SceneTruth(const SceneScript& script);

  /// Whether the state after `step` is known: the start, every quarter of the way, the end, and what the removal
  /// leaves, which counts as one more step.
  [[nodiscard]] bool knows(std::size_t step) const { return digests_.contains(step); }

  [[nodiscard]] const PairDigest& after(std::size_t step) const { return digests_.at(step); }

  /// Empty when `pairs` are those after `step`; else a sentence with the first pair that is wrong.
  [[nodiscard]] std::string complaint(std::size_t step, const std::vector<ObjectPair>& pairs) const;

 private:
  void advance(std::size_t step, OverlapOracle& oracle) const;

  const SceneScript& script_;
  std::map<std::size_t, PairDigest> digests_;  // by step
};

}  // namespace sweepgrid::bench
