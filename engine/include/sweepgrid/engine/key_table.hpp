#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <type_traits>

#include <sweepgrid/engine/key_buckets.hpp>
#include <sweepgrid/engine/stable_vector.hpp>
#include <sweepgrid/sap/ids.hpp>

namespace sweepgrid {

/// Client keys by object and objects by key. Calls for different keys may run at once: buckets are sharded by hash, a
/// lock each.
template <class Key, class Hash>
class KeyTable {
 public:
  static constexpr int kShardBits = 6;
  static constexpr std::size_t kShards = std::size_t{1} << kShardBits;

  [[nodiscard]] const Key& key(ObjectId object) const { return keys_[object]; }

  /// kNoObject when unknown. O(1).
  [[nodiscard]] ObjectId find(const Key& key) const {
    const std::uint32_t hash = hash_of(key);
    const Shard& shard = shards_[shard_of(hash)];
    const std::lock_guard lock(shard.mutex);
    return shard.buckets.find(tag_of(hash), is_key(key));
  }

  /// Calls `make` for the new object's id unless the key is known; returns whether it was called. O(1).
  template <class Make>
  bool insert(const Key& key, Make&& make) {
    const std::uint32_t hash = hash_of(key);
    Shard& shard = shards_[shard_of(hash)];
    const std::lock_guard lock(shard.mutex);
    shard.buckets.reserve(1);
    return shard.buckets.insert(tag_of(hash), is_key(key), [&] {
      const ObjectId object = make();
      make_room(std::uint64_t{object} + 1);
      keys_[object] = key;
      return object;
    });
  }

  /// Forgets the object's key as a key; key(object) still tells it. Precondition: known. O(1).
  void erase(ObjectId object) {
    const std::uint32_t hash = hash_of(keys_[object]);
    Shard& shard = shards_[shard_of(hash)];
    const std::lock_guard lock(shard.mutex);
    shard.buckets.erase(tag_of(hash), object);
    shard.buckets.shrink();
  }

  // In bulk: first the keys of all objects are stored and hashed, then the objects go into the buckets, or out of them,
  // one by one or one shard at a time.

  /// An object of a shard, by item of the call.
  struct Entry {
    std::uint32_t tag;
    std::uint32_t item;
  };
  [[nodiscard]] static std::size_t shard_of(std::uint32_t hash) { return hash >> (32 - kShardBits); }
  [[nodiscard]] static Entry entry(std::uint32_t hash, std::size_t item) {
    return {tag_of(hash), static_cast<std::uint32_t>(item)};
  }

  /// Makes room for keys of objects below `bound`.
  void make_room(std::uint64_t bound) {
    if (bound <= keys_.size()) return;
    const std::lock_guard growth(growth_);
    keys_.grow(bound + kAhead - bound % kAhead);  // so that the lock is not taken for each
  }
  /// Tells the key of an object, for which there must be room, but not yet the object of the key. Returns its hash.
  std::uint32_t store(ObjectId object, const Key& key) {
    keys_[object] = key;
    return hash_of(key);
  }
  [[nodiscard]] std::uint32_t hash(ObjectId object) const { return hash_of(keys_[object]); }

  /// Returns whether the key was unknown; only then is the object known by it now. Precondition: store().
  bool insert(std::uint32_t hash, ObjectId object) {
    Shard& shard = shards_[shard_of(hash)];
    const std::lock_guard lock(shard.mutex);
    shard.buckets.reserve(1);
    return shard.buckets.insert(tag_of(hash), is_key(keys_[object]), [object] { return object; });
  }
  /// As above for all entries up to the first whose key is known. `done`: how many went in, also when it throws.
  template <class IdOf>
  void insert_shard(std::size_t index, std::span<const Entry> entries, const IdOf& id_of, std::size_t& done) {
    Shard& shard = shards_[index];
    const std::lock_guard lock(shard.mutex);
    shard.buckets.reserve(entries.size());
    for (const Entry& entry : entries) {
      const ObjectId object = id_of(entry.item);
      if (!shard.buckets.insert(entry.tag, is_key(keys_[object]), [object] { return object; })) return;
      ++done;
    }
  }
  template <class IdOf>
  void erase_shard(std::size_t index, std::span<const Entry> entries, const IdOf& id_of) {
    Shard& shard = shards_[index];
    const std::lock_guard lock(shard.mutex);
    for (const Entry& entry : entries) shard.buckets.erase(entry.tag, id_of(entry.item));
    shard.buckets.shrink();
  }

  /// Gives back the memory of keys of objects from `bound` on. Not thread-safe.
  void trim(std::uint64_t bound) { keys_.shrink(bound); }

  [[nodiscard]] std::size_t bytes() const {
    std::size_t total = keys_.bytes();
    for (const Shard& shard : shards_) total += shard.buckets.bytes();
    return total;
  }

 private:
  static constexpr std::uint64_t kAhead = 256;

  struct alignas(64) Shard {
    mutable std::mutex mutex;
    KeyBuckets buckets;
  };

  // std::hash of an integer is often the integer itself; all its bits must take part in all bits of the result.
  static std::uint32_t hash_of(const Key& key) {
    std::uint64_t h = static_cast<std::uint64_t>(Hash{}(key));
    h = (h ^ h >> 33) * 0xff51afd7ed558ccdU;
    h = (h ^ h >> 33) * 0xc4ceb9fe1a85ec53U;
    return static_cast<std::uint32_t>(h >> 32);
  }
  [[nodiscard]] static std::uint32_t tag_of(std::uint32_t hash) { return hash << kShardBits; }
  [[nodiscard]] auto is_key(const Key& key) const {
    return [this, &key](ObjectId object) { return keys_[object] == key; };
  }

  StableVector<Key> keys_;  // by object
  std::array<Shard, kShards> shards_;
  std::mutex growth_;
};

}  // namespace sweepgrid
