#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <sweepgrid/engine/digit_sort.hpp>
#include <sweepgrid/engine/key_table.hpp>
#include <sweepgrid/engine/sharded_sort.hpp>
#include <sweepgrid/engine/stable_vector.hpp>
#include <sweepgrid/sap/ids.hpp>

namespace sweepgrid {

/// Numbers in the order of keys, so that pairs can be sorted by numbers. Integers whose order is that of their values
/// are their own ranks; of other keys, those of the objects of one list of events are sorted, in parallel, and ranks
/// are places.
///
/// The order of keys must be total. No two objects of one list have the same key, so two that compare equal are found
/// here, where they lie side by side.
class KeyRanks {
 public:
  explicit KeyRanks(const KeyTable& keys) : keys_(keys) {}

  /// Whether ranks need no sorting.
  [[nodiscard]] bool values() const { return keys_.type().kind != KeyType::Kind::kOther; }

  // ---- if not values(): by shard, then by range

  void reset(std::size_t shards);
  [[nodiscard]] std::size_t shards() const { return sort_.shards(); }
  /// Objects of which ranks are wanted; any number of times. Different shards at once.
  [[nodiscard]] std::vector<ObjectId>& shard(std::size_t index) { return sort_.shard(index); }
  void sort_shard(std::size_t index);
  /// Returns the number of ranges, at most `ranges`. `bound`: objects are below it.
  std::size_t cut(std::size_t ranges, ObjectId bound);
  void merge(std::size_t range);
  /// Throws std::invalid_argument that names two objects whose keys compare equal: the same two for any number of
  /// shards and ranges.
  void require_total() const;

  // ---- then

  /// Calls `body(rank_of)`, where `rank_of(object)` is its rank.
  template <class Body>
  void with(Body&& body) const {
    const std::uint64_t sign = sign_bit();
    const auto by_value = [&]<class Integer>(Integer /*type*/) {
      body([this, sign](ObjectId object) { return std::uint64_t{load<Integer>(keys_.key(object))} ^ sign; });
    };
    if (!values()) return body([this](ObjectId object) { return std::uint64_t{ranks_[object]}; });
    switch (keys_.type().size) {
      case 1:
        return by_value(std::uint8_t{});
      case 2:
        return by_value(std::uint16_t{});
      case 4:
        return by_value(std::uint32_t{});
      default:
        return by_value(std::uint64_t{});
    }
  }

  /// If not values(): the key of a rank.
  [[nodiscard]] const void* key(std::uint64_t rank) const {
    return keys_.key(by_rank_[static_cast<std::size_t>(rank)]);
  }
  /// If values(): writes pairs of keys to an array of them.
  void write(void* pairs, std::span<const RankPair> ranks) const;

  void trim(ObjectId bound) { ranks_.shrink(bound); }
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct ByKey {
    const KeyTable* keys;
    [[nodiscard]] bool less(ObjectId a, ObjectId b) const { return keys->type().less(keys->key(a), keys->key(b)); }
    void sort(std::span<ObjectId> objects) const;
  };
  struct Tie {
    ObjectId first = kNoObject;
    ObjectId second = kNoObject;
  };

  /// Flipped, it makes signed integers follow each other as unsigned ones do.
  [[nodiscard]] std::uint64_t sign_bit() const {
    return keys_.type().kind == KeyType::Kind::kSigned ? std::uint64_t{1} << (8 * keys_.type().size - 1) : 0;
  }
  template <class Integer>
  [[nodiscard]] static Integer load(const void* key) {
    Integer value;
    std::memcpy(&value, key, sizeof value);
    return value;
  }

  const KeyTable& keys_;
  ShardedSort<ObjectId, ByKey> sort_;
  StableVector<std::uint32_t> ranks_;  // by object
  std::span<ObjectId> by_rank_;
  std::vector<Tie> ties_;  // by range
};

}  // namespace sweepgrid
