#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include <sweepgrid/engine/digit_sort.hpp>
#include <sweepgrid/engine/events.hpp>

namespace sweepgrid {

/// Sorts what arrives in shards into one list, in parallel: each shard is sorted by itself, then the key space is cut
/// into ranges of about equal size and each range is merged by itself. The result does not depend on the number of
/// shards or ranges.
template <class Key, class Order>
class EventOrder {
 public:
  using PairType = Pair<Key>;

  /// An object, not a function: sorting then has it inlined.
  static constexpr auto kLess = [](const PairType& a, const PairType& b) {
    const Order order;
    if constexpr (std::is_integral_v<Key>) {
      // Without a branch that nobody could foresee.
      return (order(a.first, b.first) | (!order(b.first, a.first) & order(a.second, b.second))) != 0;
    } else {
      if (order(a.first, b.first)) return true;
      if (order(b.first, a.first)) return false;
      return static_cast<bool>(order(a.second, b.second));
    }
  };

  /// Puts the two keys in order.
  static PairType pair(const Key& a, const Key& b) { return Order{}(b, a) ? PairType{b, a} : PairType{a, b}; }

  void reset(std::size_t shards) {
    shards_.resize(shards);
    for (auto& shard : shards_) shard.clear();
  }

  [[nodiscard]] std::size_t shards() const { return shards_.size(); }

  /// The list of a shard, to be filled and then sorted.
  [[nodiscard]] std::vector<PairType>& shard(std::size_t index) { return shards_[index]; }
  /// Also drops doubles, which lie in one shard.
  void sort_shard(std::size_t index) {
    auto& shard = shards_[index];
    sort(shard);
    shard.erase(std::unique(shard.begin(), shard.end()), shard.end());
  }

  /// Chooses at most `ranges` ranges and sizes `out`; returns how many there are: 0 when nothing is left to be merged.
  /// Precondition: every shard is sorted.
  std::size_t cut(std::size_t ranges, std::vector<PairType>& out);

  /// Writes range `index` of the order to `out`. Different ranges may be merged at once.
  void merge_range(std::size_t index, std::vector<PairType>& out) const;

 private:
  static void sort(std::span<PairType> pairs) {
    if constexpr (DigitSort<Key>::template kFits<Order>) {
      if (DigitSort<Key>::sort(pairs)) return;
    }
    std::sort(pairs.begin(), pairs.end(), kLess);
  }

  /// Where range `index` begins in a shard; there is one more, at which the last one ends.
  [[nodiscard]] auto begin_of(std::size_t index, const std::vector<PairType>& shard) const {
    if (index == 0) return shard.begin();
    if (index > splitters_.size()) return shard.end();
    return std::lower_bound(shard.begin(), shard.end(), splitters_[index - 1], kLess);
  }

  std::vector<std::vector<PairType>> shards_;
  std::vector<PairType> splitters_;  // the least pair of each range but the first
};

template <class Key, class Order>
std::size_t EventOrder<Key, Order>::cut(std::size_t ranges, std::vector<PairType>& out) {
  constexpr std::size_t kSmallest = 256;  // a range with fewer events is not worth a task
  constexpr std::size_t kSamples = 16;    // of all shards for each range
  if (shards_.size() == 1) {
    out.swap(shards_[0]);
    return 0;
  }
  std::size_t total = 0;
  for (const auto& shard : shards_) total += shard.size();
  out.resize(total);
  splitters_.clear();
  if (total == 0) return 0;
  ranges = std::clamp<std::size_t>(total / kSmallest, 1, ranges);
  if (ranges == 1) return 1;

  std::vector<PairType> samples;
  const std::size_t stride = std::max<std::size_t>(1, total / (kSamples * ranges));
  std::size_t next = stride / 2;  // in the shards one after the other: short ones have their share, too
  for (const auto& shard : shards_) {
    for (; next < shard.size(); next += stride) samples.push_back(shard[next]);
    next -= shard.size();
  }
  sort(samples);
  for (std::size_t range = 1; range < ranges; ++range) {
    splitters_.push_back(samples[range * samples.size() / ranges]);
  }
  return ranges;
}

// Looks for the ends of its range itself: for all ranges at once that would be the longest serial part of a step.
template <class Key, class Order>
void EventOrder<Key, Order>::merge_range(std::size_t index, std::vector<PairType>& out) const {
  std::size_t place = 0;
  for (const auto& shard : shards_) place += static_cast<std::size_t>(begin_of(index, shard) - shard.begin());
  auto end = out.begin() + static_cast<std::ptrdiff_t>(place);
  const auto begin = end;
  std::size_t runs = 0;
  for (const auto& shard : shards_) {
    const auto first = begin_of(index, shard);
    const auto last = begin_of(index + 1, shard);
    runs += first != last ? 1 : 0;
    end = std::copy(first, last, end);
  }
  if (runs > 1) sort({begin, end});
}

}  // namespace sweepgrid
