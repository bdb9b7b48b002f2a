#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include <sweepgrid/engine/stable_vector.hpp>
#include <sweepgrid/sap/ids.hpp>

namespace sweepgrid {

/// Client keys by object and objects by key. Calls for different keys may run at once: buckets are sharded by hash, a
/// lock each. Buckets hold ids only; the keys are compared where they lie.
template <class Key, class Hash>
class KeyTable {
 public:
  [[nodiscard]] const Key& key(ObjectId object) const { return keys_[object]; }

  /// kNoObject when unknown. O(1).
  [[nodiscard]] ObjectId find(const Key& key) const {
    const std::size_t hash = mixed(key);
    const Shard& shard = shards_[shard_of(hash)];
    const std::lock_guard lock(shard.mutex);
    return shard.buckets.empty() ? kNoObject : shard.buckets[place(shard, hash, key)];
  }

  /// Calls `make` for the new object's id unless the key is known; returns whether it was called. O(1).
  template <class Make>
  bool insert(const Key& key, Make&& make) {
    const std::size_t hash = mixed(key);
    Shard& shard = shards_[shard_of(hash)];
    const std::lock_guard lock(shard.mutex);
    if (3 * (shard.size + 1) > 2 * shard.buckets.size()) rehash(shard);
    const std::size_t bucket = place(shard, hash, key);
    if (shard.buckets[bucket] != kNoObject) return false;
    const ObjectId object = make();
    {
      const std::lock_guard growth(growth_);
      keys_.grow(std::uint64_t{object} + 1);
    }
    keys_[object] = key;
    shard.buckets[bucket] = object;
    ++shard.size;
    return true;
  }

  /// Forgets the object's key as a key; key(object) still tells it. Precondition: known.
  void erase(ObjectId object) {
    const std::size_t hash = mixed(keys_[object]);
    Shard& shard = shards_[shard_of(hash)];
    const std::lock_guard lock(shard.mutex);
    const std::size_t mask = shard.buckets.size() - 1;
    std::size_t hole = place(shard, hash, keys_[object]);
    for (std::size_t next = (hole + 1) & mask; shard.buckets[next] != kNoObject; next = (next + 1) & mask) {
      const std::size_t home = mixed(keys_[shard.buckets[next]]) & mask;
      if (((next - home) & mask) >= ((next - hole) & mask)) {
        shard.buckets[hole] = shard.buckets[next];
        hole = next;
      }
    }
    shard.buckets[hole] = kNoObject;
    --shard.size;
  }

  [[nodiscard]] std::size_t bytes() const {
    std::size_t total = keys_.bytes();
    for (const Shard& shard : shards_) total += shard.buckets.capacity() * sizeof(ObjectId);
    return total;
  }

 private:
  static constexpr int kShardBits = 4;

  struct Shard {
    mutable std::mutex mutex;
    std::vector<ObjectId> buckets;  // open addressing, linear probing, a power of two, at most 2/3 full
    std::size_t size = 0;
  };

  // std::hash of an integer is often the integer itself; its upper bits must choose a shard all the same.
  static std::size_t mixed(const Key& key) {
    const std::uint64_t h = static_cast<std::uint64_t>(Hash{}(key)) * 0x9e3779b97f4a7c15U;
    return static_cast<std::size_t>(h ^ h >> 32);
  }
  static std::size_t shard_of(std::size_t hash) { return hash >> (8 * sizeof(std::size_t) - kShardBits); }

  // Bucket of the key, or the free one where it belongs.
  std::size_t place(const Shard& shard, std::size_t hash, const Key& key) const {
    const std::size_t mask = shard.buckets.size() - 1;
    std::size_t bucket = hash & mask;
    while (shard.buckets[bucket] != kNoObject && !(keys_[shard.buckets[bucket]] == key)) bucket = (bucket + 1) & mask;
    return bucket;
  }

  void rehash(Shard& shard) {
    std::vector<ObjectId> old(shard.buckets.empty() ? 16 : 2 * shard.buckets.size(), kNoObject);
    old.swap(shard.buckets);
    for (const ObjectId object : old) {
      if (object != kNoObject) shard.buckets[place(shard, mixed(keys_[object]), keys_[object])] = object;
    }
  }

  StableVector<Key> keys_;  // by object
  std::array<Shard, std::size_t{1} << kShardBits> shards_;
  std::mutex growth_;
};

}  // namespace sweepgrid
