#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <sweepgrid/sap/high_water.hpp>
#include <sweepgrid/sap/ids.hpp>
#include <sweepgrid/sap/overlap_delta.hpp>

namespace sweepgrid {

/// In how many cells each overlapping pair overlaps (section 3.3): flat, open addressing, 64-bit keys. One shard of the
/// engine's table. Not thread-safe; shards share nothing.
class WitnessTable {
 public:
  /// A well-mixed hash: its upper bits choose a shard, its lower bits a bucket.
  [[nodiscard]] static std::uint64_t hash(PairKey pair) {
    std::uint64_t h = pair.bits() * 0x9e3779b97f4a7c15U;
    h ^= h >> 32;
    return h * 0xd6e8feb86659fd93U;
  }

  /// Adds the deltas to the counts. Order does not matter: sums commute, and counts are judged only in finish().
  void apply(std::span<const OverlapDelta> deltas);

  /// Ends a step: appends the pairs whose count left zero or reached it since the last call, in no order, and drops
  /// pairs at zero. Throws InvariantError (E1) for a count below zero, which only a bug in a cell can cause.
  void finish(std::vector<PairKey>& begins, std::vector<PairKey>& ends);

  /// Ends a step for the table's memory: what is beyond HighWater goes back. `steps`: so many steps in which nothing
  /// changed. Throws nothing.
  void note_step();
  void pass(std::size_t steps);

  /// Number of cells in which `pair` overlaps. O(1).
  [[nodiscard]] std::int32_t count(PairKey pair) const;

  /// Appends every pair that overlaps, in no order.
  void append_pairs(std::vector<PairKey>& pairs) const;

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t bytes() const {
    return entries_.capacity() * sizeof(Entry) + touched_.capacity() * sizeof(touched_[0]);
  }

 private:
  static constexpr std::int32_t kUntouched = -1;

  struct Entry {
    std::uint64_t pair = 0;  // 0 when free: a pair's upper id is never 0
    std::int32_t count = 0;
    std::int32_t before = kUntouched;  // count at the beginning of the step, once touched
  };

  /// The size of a table for so many pairs.
  [[nodiscard]] static std::size_t room_for(std::size_t pairs);
  void shrink() noexcept;
  [[nodiscard]] std::size_t find(std::uint64_t pair) const;
  void rehash(std::size_t capacity);
  void erase(std::uint64_t pair);

  std::vector<Entry> entries_;  // a power of two, at most 2/3 full
  std::size_t size_ = 0;
  std::vector<std::uint64_t> touched_;
  std::size_t most_of_step_ = 0;  // pairs
  HighWater most_pairs_;
  HighWater most_touched_;
};

}  // namespace sweepgrid
