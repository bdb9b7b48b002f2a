#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <sweepgrid/sap/ids.hpp>

namespace sweepgrid {

/// A set of pairs as a list for each object of the others, in ascending order: what an object that changed has to be
/// tested with. Each pair is in two lists.
class CandidateLists {
 public:
  /// Objects of a shard come in runs of this length; the shards take turns.
  static constexpr ObjectId kRun = 256;

  /// Makes lists for objects below `bound`, or gives back the memory of those beyond, which must be empty.
  void resize(std::size_t bound) { lists_.resize(bound); }

  [[nodiscard]] std::size_t bound() const { return lists_.size(); }
  [[nodiscard]] std::span<const ObjectId> of(ObjectId object) const { return lists_[object]; }

  /// What one worker has to do to the lists of its shard.
  class Shard {
   public:
    void reset(std::size_t index, std::size_t shards);
    void add(std::span<const PairKey> pairs) { collect(pairs, added_); }
    void remove(std::span<const PairKey> pairs) { collect(pairs, removed_); }
    /// Entries added less entries removed: two for each pair, over all shards.
    [[nodiscard]] std::int64_t growth() const { return growth_; }
    [[nodiscard]] std::uint64_t entries_added() const { return entries_added_; }

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
    std::uint64_t entries_added_ = 0;
    std::int64_t growth_ = 0;
  };

  /// Does what the shard was told, pairs that it was told twice once. Shards may be applied at once. Precondition: what
  /// is removed is there, what is added is not.
  void apply(Shard& shard);

  /// Memory in use. O(objects).
  [[nodiscard]] std::size_t bytes() const;

 private:
  std::vector<std::vector<ObjectId>> lists_;
};

}  // namespace sweepgrid
