#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "system.hpp"

namespace sweepgrid::bench {

/// Tells sets of pairs apart, whatever order their pairs and the objects in a pair come in.
struct PairDigest {
  std::uint64_t count = 0;
  std::uint64_t hash = 0;

  friend bool operator==(const PairDigest&, const PairDigest&) = default;
};

[[nodiscard]] inline PairDigest digest(const std::vector<ObjectPair>& pairs) {
  PairDigest digest{pairs.size(), 0};
  for (const auto& [a, b] : pairs) {
    // The finalizer of SplitMix64; a sum of its values does not depend on their order.
    std::uint64_t bits = (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111eb;
    digest.hash += bits ^ (bits >> 31);
  }
  return digest;
}

}  // namespace sweepgrid::bench
