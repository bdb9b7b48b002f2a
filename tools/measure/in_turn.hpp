#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace sweepgrid {

/// Samples of several contenders in turn, round after round, so that what slows the machine for a while hits all of
/// them. `contenders[i]` returns one sample; the result holds its `rounds` samples at [i].
[[nodiscard]] inline std::vector<std::vector<double>> measure_in_turn(
    int rounds, std::span<const std::function<double()>> contenders) {
  std::vector<std::vector<double>> samples(contenders.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < contenders.size(); ++i) samples[i].push_back(contenders[i]());
  }
  return samples;
}

/// first[i] / second[i] for samples of the same rounds: what slows a round cancels out.
[[nodiscard]] inline std::vector<double> ratios(std::span<const double> first, std::span<const double> second) {
  std::vector<double> result;
  for (std::size_t i = 0; i < std::min(first.size(), second.size()); ++i) result.push_back(first[i] / second[i]);
  return result;
}

}  // namespace sweepgrid
