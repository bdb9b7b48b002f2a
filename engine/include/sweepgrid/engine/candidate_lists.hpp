#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <sweepgrid/sap/high_water.hpp>
#include <sweepgrid/sap/ids.hpp>

namespace sweepgrid {

/// A set of pairs as a list for each object of the others, in ascending order: what an object that changed has to be
/// tested with. Each pair is in two lists. Changes are made in two parts, so that a step that fails changes none.
class CandidateLists {
 public:
  /// Objects of a shard come in runs of this length; the shards take turns.
  static constexpr ObjectId kRun = 256;

  /// Makes lists for objects below `bound`, which grows. If it throws, nothing has changed.
  void grow(std::size_t bound) { lists_.resize(bound); }
  /// Gives back the memory of objects from `bound` on. Precondition: their lists are empty.
  void trim(std::size_t bound);

  [[nodiscard]] std::size_t bound() const { return lists_.size(); }
  [[nodiscard]] std::span<const ObjectId> of(ObjectId object) const {
    return {lists_[object].entries.get(), lists_[object].size};
  }

  /// What one worker has to do to the lists of its shard.
  class Shard {
   public:
    void reset(std::size_t index, std::size_t shards);
    void add(std::span<const PairKey> pairs) { collect(pairs, added_); }
    void remove(std::span<const PairKey> pairs) { collect(pairs, removed_); }
    /// Entries added and removed: two for each pair, over all shards. Known once the shard is prepared.
    [[nodiscard]] std::size_t entries_added() const { return added_.size(); }
    [[nodiscard]] std::size_t entries_removed() const { return removed_.size(); }
    /// Forgets all, and keeps what memory steps of late needed.
    void recycle();
    [[nodiscard]] std::size_t bytes() const { return (added_.capacity() + removed_.capacity()) * sizeof(Entry); }

   private:
    friend class CandidateLists;
    /// The entry `other` in the list of `object`, in the order of objects.
    struct Entry {
      ObjectId object;
      ObjectId other;
      friend auto operator<=>(const Entry&, const Entry&) = default;
    };
    void collect(std::span<const PairKey> pairs, std::vector<Entry>& entries) const;

    std::size_t index_ = 0;
    std::size_t shards_ = 1;
    std::vector<Entry> added_;
    std::vector<Entry> removed_;
    HighWater added_water_;
    HighWater removed_water_;
  };

  /// Makes room for what the shard was told; pairs that it was told twice count once. Shards may be prepared at once.
  void prepare(Shard& shard);
  /// Does what the shard was told. Shards may be applied at once. Precondition: it is prepared; what is removed is
  /// there, what is added is not.
  void apply(const Shard& shard) noexcept;

  /// Ends a step, an idle one too: lists keep twice the most that they held in 64 steps or more, the memory beyond that
  /// goes back. `entries`: how many there are in all lists. O(objects / 64), or O(1) where less than half is unused.
  void end_step(std::size_t entries) noexcept;

  /// Memory in use. O(1).
  [[nodiscard]] std::size_t bytes() const {
    return lists_.capacity() * sizeof(List) + capacity_.load(std::memory_order_relaxed) * sizeof(ObjectId);
  }

 private:
  static constexpr std::size_t kSteps = 64;
  static constexpr std::uint32_t kFewest = 4;  // entries that memory is allocated for

  struct List {
    std::unique_ptr<ObjectId[]> entries;
    std::uint32_t size = 0;
    std::uint32_t capacity = 0;
    std::uint32_t most = 0;         // size since it was looked at last
    std::uint32_t most_before = 0;  // size between the two times before
  };

  void reserve(List& list, std::size_t size);
  static void remove(List& list, std::span<const Shard::Entry> entries);
  static void merge(List& list, std::span<const Shard::Entry> entries);
  void give_back(List& list) noexcept;

  std::vector<List> lists_;
  std::atomic<std::size_t> capacity_ = 0;  // of all lists
  std::size_t next_ = 0;                   // list to be looked at
};

}  // namespace sweepgrid
