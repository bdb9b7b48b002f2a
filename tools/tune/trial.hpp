#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tune/candidate.hpp"
#include "tune/demand.hpp"
#include "tune/scene_sample.hpp"

namespace sweepgrid::tune {

/// What a candidate took and reported in the measured steps of a sample.
struct Trial {
  std::vector<double> least_ms;  ///< by step: the least of all rounds, for whatever else runs on the machine only adds
  int rounds = 0;
  std::uint64_t true_pairs = 0;  ///< these are sums over the steps, and exact
  std::uint64_t reported_pairs = 0;
  std::uint64_t missed_pairs = 0;
  std::uint64_t extra_pairs = 0;
  std::size_t grids = 0;  ///< at the end
  double cell_size = 0;   ///< of the finest, in the engine's units
  std::string given_up;   ///< why it was not played to the end; then nothing else counts

  [[nodiscard]] double step_ms() const;
  [[nodiscard]] double candidates() const;  ///< pairs reported per step
  /// A step together with a narrow phase for what it reports.
  [[nodiscard]] double total_ms(double narrow_ns) const;
  [[nodiscard]] double missed() const;  ///< part of the true pairs
  [[nodiscard]] double extra() const;   ///< part of the reported pairs
};

/// Whether it met the demand, going by what was measured.
[[nodiscard]] bool met(const Trial& trial, const Demand& demand);

/// Plays one more round of a candidate. The first round also looks at the pairs, and gives up once it is clear that a
/// step will cost more than `limit_ms`.
using PlayRound = std::function<void(const Candidate&, Trial&, double limit_ms)>;

/// That of a sample. Keeps references.
[[nodiscard]] PlayRound round_player(const SceneSample& sample, const Demand& demand);

}  // namespace sweepgrid::tune
