#include <sweepgrid/engine/candidate_lists.hpp>

#include <algorithm>

namespace sweepgrid {

void CandidateLists::Shard::reset(std::size_t index, std::size_t shards) {
  index_ = index;
  shards_ = shards;
  added_.clear();
  removed_.clear();
  entries_added_ = 0;
  growth_ = 0;
}

void CandidateLists::Shard::collect(std::span<const PairKey> pairs, std::vector<Entry>& entries) const {
  for (const PairKey pair : pairs) {
    if (pair.lower() / kRun % shards_ == index_) entries.push_back({pair.lower(), pair.upper()});
    if (pair.upper() / kRun % shards_ == index_) entries.push_back({pair.upper(), pair.lower()});
  }
}

void CandidateLists::apply(Shard& shard) {
  const auto in_order = [](auto& entries) {
    std::sort(entries.begin(), entries.end());
    entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  };
  in_order(shard.removed_);
  in_order(shard.added_);
  const auto for_lists = [this](const std::vector<Shard::Entry>& entries, auto&& change) {
    for (auto first = entries.begin(), last = first; first != entries.end(); first = last) {
      while (last != entries.end() && last->object == first->object) ++last;
      change(lists_[first->object], first, last);
    }
  };
  for_lists(shard.removed_, [](std::vector<ObjectId>& list, auto first, auto last) {
    auto kept = std::lower_bound(list.begin(), list.end(), first->other);
    for (auto entry = kept; entry != list.end(); ++entry) {
      if (first != last && *entry == first->other) {
        ++first;
      } else {
        *kept++ = *entry;
      }
    }
    list.erase(kept, list.end());
    if (list.empty()) list.shrink_to_fit();
  });
  for_lists(shard.added_, [](std::vector<ObjectId>& list, auto first, auto last) {
    const auto known = static_cast<std::ptrdiff_t>(list.size());
    for (; first != last; ++first) list.push_back(first->other);
    std::inplace_merge(list.begin(), list.begin() + known, list.end());
  });
  shard.entries_added_ = shard.added_.size();
  shard.growth_ = static_cast<std::int64_t>(shard.added_.size()) - static_cast<std::int64_t>(shard.removed_.size());
}

std::size_t CandidateLists::bytes() const {
  std::size_t total = lists_.capacity() * sizeof(lists_[0]);
  for (const auto& list : lists_) total += list.capacity() * sizeof(ObjectId);
  return total;
}

}  // namespace sweepgrid
