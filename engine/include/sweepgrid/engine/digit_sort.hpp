#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <sweepgrid/sap/high_water.hpp>

namespace sweepgrid {

/// A pair by the ranks of its objects.
struct RankPair {
  std::uint64_t first;
  std::uint64_t second;

  friend bool operator==(const RankPair&, const RankPair&) = default;
};

/// Sorts pairs of ranks by first, then second. A pair is packed into one number that has only the bits in which the
/// ranks at hand differ, and sorted digit by digit, which takes no unpredictable branch: dense ranks take few passes.
/// Few pairs, and ranks that differ in more than 55 bits, are compared instead.
class DigitSort {
 public:
  /// O(n) for a given spread of ranks.
  void sort(std::span<RankPair> pairs);

  /// Ends a step: memory that sorting has not needed for long goes back.
  void rest() { high_water_.recycle(packed_); }
  [[nodiscard]] std::size_t bytes() const { return packed_.capacity() * sizeof(packed_[0]); }

 private:
  std::vector<std::uint64_t> packed_;
  HighWater high_water_;
};

}  // namespace sweepgrid
