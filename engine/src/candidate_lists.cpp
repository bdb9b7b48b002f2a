#include <sweepgrid/engine/candidate_lists.hpp>

#include <algorithm>
#include <new>
#include <utility>

namespace sweepgrid {
namespace {

/// Calls `visit(object, its entries)` for the objects of entries in their order.
template <class Entry, class Visit>
void for_objects(std::span<const Entry> entries, Visit&& visit) {
  for (std::size_t first = 0, last = 0; first != entries.size(); first = last) {
    while (last != entries.size() && entries[last].object == entries[first].object) ++last;
    visit(entries[first].object, entries.subspan(first, last - first));
  }
}

}  // namespace

void CandidateLists::trim(std::size_t bound) {
  if (bound >= lists_.size()) return;
  for (std::size_t object = bound; object < lists_.size(); ++object) {
    capacity_.fetch_sub(lists_[object].capacity, std::memory_order_relaxed);
  }
  lists_.resize(bound);
  lists_.shrink_to_fit();
}

// ---- what a step changes

void CandidateLists::Shard::reset(std::size_t index, std::size_t shards) {
  index_ = index;
  shards_ = shards;
  added_.clear();
  removed_.clear();
}

void CandidateLists::Shard::recycle() {
  added_water_.recycle(added_);
  removed_water_.recycle(removed_);
}

void CandidateLists::Shard::collect(std::span<const PairKey> pairs, std::vector<Entry>& entries) const {
  for (const PairKey pair : pairs) {
    if (pair.lower() / kRun % shards_ == index_) entries.push_back({pair.lower(), pair.upper()});
    if (pair.upper() / kRun % shards_ == index_) entries.push_back({pair.upper(), pair.lower()});
  }
}

void CandidateLists::prepare(Shard& shard) {
  for (auto* const entries : {&shard.removed_, &shard.added_}) {
    std::sort(entries->begin(), entries->end());
    entries->erase(std::unique(entries->begin(), entries->end()), entries->end());
  }
  for_objects(std::span<const Shard::Entry>(shard.added_),
              [this](ObjectId object, auto entries) { reserve(lists_[object], lists_[object].size + entries.size()); });
}

void CandidateLists::apply(const Shard& shard) noexcept {
  for_objects(std::span<const Shard::Entry>(shard.removed_),
              [this](ObjectId object, auto entries) { remove(lists_[object], entries); });
  for_objects(std::span<const Shard::Entry>(shard.added_),
              [this](ObjectId object, auto entries) { merge(lists_[object], entries); });
}

void CandidateLists::reserve(List& list, std::size_t size) {
  if (size <= list.capacity) return;
  const std::size_t capacity = std::max({size, std::size_t{kFewest}, list.capacity + std::size_t{list.capacity} / 2});
  auto entries = std::make_unique_for_overwrite<ObjectId[]>(capacity);
  std::copy_n(list.entries.get(), list.size, entries.get());
  list.entries = std::move(entries);
  capacity_.fetch_add(capacity - list.capacity, std::memory_order_relaxed);
  list.capacity = static_cast<std::uint32_t>(capacity);
}

void CandidateLists::remove(List& list, std::span<const Shard::Entry> entries) {
  ObjectId* const end = list.entries.get() + list.size;
  ObjectId* kept = std::lower_bound(list.entries.get(), end, entries.front().other);
  auto entry = entries.begin();
  for (const ObjectId* other = kept; other != end; ++other) {
    if (entry != entries.end() && *other == entry->other) {
      ++entry;
    } else {
      *kept++ = *other;
    }
  }
  list.size = static_cast<std::uint32_t>(kept - list.entries.get());
}

// From the back, so that nothing is overwritten before it has moved.
void CandidateLists::merge(List& list, std::span<const Shard::Entry> entries) {
  ObjectId* const all = list.entries.get();
  std::size_t old = list.size;
  std::size_t place = old + entries.size();
  list.size = static_cast<std::uint32_t>(place);
  list.most = std::max(list.most, list.size);
  for (std::size_t entry = entries.size(); entry > 0;) {
    const bool later = old > 0 && all[old - 1] > entries[entry - 1].other;
    all[--place] = later ? all[--old] : entries[--entry].other;
  }
}

// ---- memory

// Every list once in 64 steps: what it held most since the time before last is the most of 64 steps at least.
void CandidateLists::end_step(std::size_t entries) noexcept {
  if (capacity_.load(std::memory_order_relaxed) <= 2 * entries) return;
  const std::size_t visits = std::min(lists_.size(), (lists_.size() + kSteps - 1) / kSteps);
  for (std::size_t visit = 0; visit < visits; ++visit) {
    if (next_ >= lists_.size()) next_ = 0;
    give_back(lists_[next_++]);
  }
}

void CandidateLists::give_back(List& list) noexcept {
  std::uint32_t most = std::max(list.most, list.most_before);
  if (most > 0) most = std::max(most, kFewest);
  list.most_before = list.most;
  list.most = list.size;
  if (list.capacity / 2 <= most) return;
  std::unique_ptr<ObjectId[]> entries;
  if (most > 0) {
    entries.reset(new (std::nothrow) ObjectId[most]);
    if (entries == nullptr) return;  // it keeps what it has
    std::copy_n(list.entries.get(), list.size, entries.get());
  }
  list.entries = std::move(entries);
  capacity_.fetch_sub(list.capacity - most, std::memory_order_relaxed);
  list.capacity = most;
}

}  // namespace sweepgrid
