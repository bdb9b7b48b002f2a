#include <sweepgrid/engine/witness_table.hpp>

#include <algorithm>
#include <bit>
#include <new>
#include <string>
#include <utility>

#include <sweepgrid/sap/invariant.hpp>

namespace sweepgrid {

// Index of the pair's entry, or of the free one where it belongs. Precondition: a free entry exists.
std::size_t WitnessTable::find(std::uint64_t pair) const {
  const std::size_t mask = entries_.size() - 1;
  std::size_t index = hash(std::bit_cast<PairKey>(pair)) & mask;
  while (entries_[index].pair != pair && entries_[index].pair != 0) index = (index + 1) & mask;
  return index;
}

void WitnessTable::apply(std::span<const OverlapDelta> deltas) {
  for (const OverlapDelta& delta : deltas) {
    if (3 * (size_ + 1) > 2 * entries_.size()) rehash(room_for(size_ + 1));
    Entry& entry = entries_[find(delta.pair.bits())];
    if (entry.pair == 0) {
      entry.pair = delta.pair.bits();
      ++size_;
    }
    if (entry.before == kUntouched) {
      entry.before = entry.count;
      touched_.push_back(entry.pair);
    }
    entry.count += delta.change;
  }
}

void WitnessTable::finish(std::vector<PairKey>& begins, std::vector<PairKey>& ends) {
  most_of_step_ = std::max(most_of_step_, size_);
  for (const std::uint64_t pair : touched_) {
    Entry& entry = entries_[find(pair)];
    const auto key = std::bit_cast<PairKey>(pair);
    require_invariant(entry.count >= 0, "E1", [&] {
      return "pair of objects " + std::to_string(key.lower()) + " and " + std::to_string(key.upper()) +
             " has a witness count of " + std::to_string(entry.count);
    });
    if (entry.before == 0 && entry.count > 0) begins.push_back(key);
    if (entry.before > 0 && entry.count == 0) ends.push_back(key);
    entry.before = kUntouched;
    if (entry.count == 0) erase(pair);
  }
  most_touched_.recycle(touched_);
}

void WitnessTable::note_step() {
  most_pairs_.note(std::exchange(most_of_step_, 0));
  shrink();
}

void WitnessTable::pass(std::size_t steps) {
  most_touched_.pass(steps);
  most_touched_.release(touched_);
  most_pairs_.pass(steps, size_);
  shrink();
}

std::size_t WitnessTable::room_for(std::size_t pairs) {
  return pairs == 0 ? 0 : std::bit_ceil(std::max<std::size_t>(16, pairs + (pairs + 1) / 2));
}

void WitnessTable::shrink() noexcept {
  // One more, because apply() makes room before it knows whether the pair is new.
  const std::size_t most = std::max(most_pairs_.most(), size_);
  const std::size_t wanted = most == 0 ? 0 : room_for(most + 1);
  if (entries_.size() <= wanted) return;
  try {
    rehash(wanted);
  } catch (const std::bad_alloc&) {
    // Then a later step tries again.
  }
}

std::int32_t WitnessTable::count(PairKey pair) const {
  return entries_.empty() ? 0 : entries_[find(pair.bits())].count;
}

void WitnessTable::append_pairs(std::vector<PairKey>& pairs) const {
  for (const Entry& entry : entries_) {
    if (entry.pair != 0) pairs.push_back(std::bit_cast<PairKey>(entry.pair));
  }
}

void WitnessTable::rehash(std::size_t capacity) {
  std::vector<Entry> old(capacity);
  old.swap(entries_);
  for (const Entry& entry : old) {
    if (entry.pair != 0) entries_[find(entry.pair)] = entry;
  }
}

// Backward-shift deletion: no tombstones, so the table never degrades under churn.
void WitnessTable::erase(std::uint64_t pair) {
  const std::size_t mask = entries_.size() - 1;
  std::size_t hole = find(pair);
  for (std::size_t next = (hole + 1) & mask; entries_[next].pair != 0; next = (next + 1) & mask) {
    const std::size_t home = hash(std::bit_cast<PairKey>(entries_[next].pair)) & mask;
    if (((next - home) & mask) >= ((next - hole) & mask)) {
      entries_[hole] = entries_[next];
      hole = next;
    }
  }
  entries_[hole] = Entry{};
  --size_;
}

}  // namespace sweepgrid
