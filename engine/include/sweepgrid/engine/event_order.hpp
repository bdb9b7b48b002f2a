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

  std::vector<std::vector<PairType>> shards_;
  std::vector<std::size_t> cuts_;     // [range][shard]: where the range begins in the shard; one more range ends it
  std::vector<std::size_t> offsets_;  // [range]: where it begins in the output
};

template <class Key, class Order>
std::size_t EventOrder<Key, Order>::cut(std::size_t ranges, std::vector<PairType>& out) {
  constexpr std::size_t kSmallest = 512;  // a range with fewer events is not worth a task
  constexpr std::size_t kSamples = 16;    // of all shards for each range
  if (shards_.size() == 1) {
    out.swap(shards_[0]);
    return 0;
  }
  std::size_t total = 0;
  for (const auto& shard : shards_) total += shard.size();
  out.resize(total);
  if (total == 0) return 0;
  ranges = std::clamp<std::size_t>(total / kSmallest, 1, ranges);

  std::vector<PairType> samples;
  if (ranges > 1) {
    const std::size_t stride = std::max<std::size_t>(1, total / (kSamples * ranges));
    for (const auto& shard : shards_) {
      for (std::size_t i = stride / 2; i < shard.size(); i += stride) samples.push_back(shard[i]);
    }
    std::sort(samples.begin(), samples.end(), kLess);
  }
  const std::size_t width = shards_.size();
  cuts_.assign((ranges + 1) * width, 0);
  offsets_.assign(ranges + 1, 0);
  for (std::size_t range = 1; range <= ranges; ++range) {
    for (std::size_t s = 0; s < width; ++s) {
      const auto& shard = shards_[s];
      cuts_[range * width + s] =
          range == ranges ? shard.size()
                          : static_cast<std::size_t>(std::lower_bound(shard.begin(), shard.end(),
                                                                      samples[range * samples.size() / ranges], kLess) -
                                                     shard.begin());
      offsets_[range] += cuts_[range * width + s];
    }
  }
  return ranges;
}

template <class Key, class Order>
void EventOrder<Key, Order>::merge_range(std::size_t index, std::vector<PairType>& out) const {
  const std::size_t width = shards_.size();
  auto end = out.begin() + static_cast<std::ptrdiff_t>(offsets_[index]);
  const auto begin = end;
  std::size_t runs = 0;
  for (std::size_t s = 0; s < width; ++s) {
    const auto first = shards_[s].begin() + static_cast<std::ptrdiff_t>(cuts_[index * width + s]);
    const auto last = shards_[s].begin() + static_cast<std::ptrdiff_t>(cuts_[(index + 1) * width + s]);
    runs += first != last ? 1 : 0;
    end = std::copy(first, last, end);
  }
  if (runs > 1) sort({begin, end});
}

}  // namespace sweepgrid
