#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include <sweepgrid/sap/high_water.hpp>

namespace sweepgrid {

/// Sorts what arrives in shards, in parallel: each shard is sorted by itself, then the items are cut into ranges of
/// about equal size, and each range is merged by itself. The result does not depend on the number of shards or ranges.
///
/// `Sorter`: a strict weak order of items as `bool less(a, b) const`, and `void sort(std::span<Item>)`, which may use
/// memory of the sorter's own. There is one for each shard, and one for each range.
template <class Item, class Sorter>
class ShardedSort {
 public:
  /// Begins a new list.
  void reset(std::size_t shards) {
    if (shards_.size() < shards) shards_.resize(shards);
    used_ = shards;
    for (Shard& shard : shards_) shard.high_water.recycle(shard.items);
    merged_high_water_.recycle(merged_);
    splitters_.clear();
  }

  [[nodiscard]] std::size_t shards() const { return used_; }

  /// The list of a shard, to be filled and then sorted.
  [[nodiscard]] std::vector<Item>& shard(std::size_t index) { return shards_[index].items; }
  void sort_shard(std::size_t index, Sorter& sorter) { sorter.sort(shards_[index].items); }

  /// Items in all shards.
  [[nodiscard]] std::size_t size() const {
    std::size_t total = 0;
    for (std::size_t shard = 0; shard < used_; ++shard) total += shards_[shard].items.size();
    return total;
  }

  /// Chooses at most `ranges` ranges; returns how many there are, 0 when there is no item. Precondition: every shard is
  /// sorted.
  std::size_t cut(std::size_t ranges, Sorter& sorter);

  /// A part of the order.
  struct Range {
    std::size_t place;  // of its first item among all
    std::span<Item> items;
  };
  /// Different ranges may be merged at once.
  Range merge(std::size_t index, Sorter& sorter);

  /// All items in order. Precondition: every range is merged.
  [[nodiscard]] std::span<Item> sorted() { return used_ == 1 ? std::span(shards_[0].items) : std::span(merged_); }

  [[nodiscard]] std::size_t bytes() const {
    std::size_t items = merged_.capacity() + splitters_.capacity() + samples_.capacity();
    for (const Shard& shard : shards_) items += shard.items.capacity();
    return items * sizeof(Item) + shards_.capacity() * sizeof(Shard);
  }

 private:
  struct Shard {
    std::vector<Item> items;
    HighWater high_water;
  };

  /// Where range `index` begins in a shard; there is one more, at which the last one ends.
  [[nodiscard]] auto begin_of(std::size_t index, Shard& shard, const Sorter& sorter) const {
    auto& items = shard.items;
    if (index == 0) return items.begin();
    if (index > splitters_.size()) return items.end();
    return std::lower_bound(items.begin(), items.end(), splitters_[index - 1],
                            [&](const Item& a, const Item& b) { return sorter.less(a, b); });
  }

  std::vector<Shard> shards_;
  std::size_t used_ = 0;
  std::vector<Item> merged_;
  HighWater merged_high_water_;
  std::vector<Item> splitters_;  // the least item of each range but the first
  std::vector<Item> samples_;
};

template <class Item, class Sorter>
std::size_t ShardedSort<Item, Sorter>::cut(std::size_t ranges, Sorter& sorter) {
  constexpr std::size_t kSmallest = 256;  // a range with fewer items is not worth a task
  constexpr std::size_t kSamples = 16;    // of all shards for each range
  const std::size_t total = size();
  splitters_.clear();
  if (total == 0) return 0;
  if (used_ == 1) return 1;
  merged_.resize(total);
  ranges = std::clamp<std::size_t>(total / kSmallest, 1, ranges);
  if (ranges == 1) return 1;

  samples_.clear();
  const std::size_t stride = std::max<std::size_t>(1, total / (kSamples * ranges));
  std::size_t next = stride / 2;  // in the shards one after the other: short ones have their share, too
  for (std::size_t shard = 0; shard < used_; ++shard) {
    const auto& items = shards_[shard].items;
    for (; next < items.size(); next += stride) samples_.push_back(items[next]);
    next -= items.size();
  }
  sorter.sort(samples_);
  for (std::size_t range = 1; range < ranges; ++range) {
    splitters_.push_back(samples_[range * samples_.size() / ranges]);
  }
  return ranges;
}

// Looks for the ends of its range itself: for all ranges at once that would be the longest serial part of a step.
template <class Item, class Sorter>
auto ShardedSort<Item, Sorter>::merge(std::size_t index, Sorter& sorter) -> Range {
  if (used_ == 1) return {0, shards_[0].items};
  std::size_t place = 0;
  for (std::size_t shard = 0; shard < used_; ++shard) {
    place += static_cast<std::size_t>(begin_of(index, shards_[shard], sorter) - shards_[shard].items.begin());
  }
  const auto begin = merged_.begin() + static_cast<std::ptrdiff_t>(place);
  auto end = begin;
  std::size_t runs = 0;
  for (std::size_t shard = 0; shard < used_; ++shard) {
    const auto first = begin_of(index, shards_[shard], sorter);
    const auto last = begin_of(index + 1, shards_[shard], sorter);
    runs += first != last ? 1 : 0;
    end = std::copy(first, last, end);
  }
  if (runs > 1) sorter.sort({begin, end});
  return {place, {begin, end}};
}

}  // namespace sweepgrid
