#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>

#include <sweepgrid/engine/key_buckets.hpp>
#include <sweepgrid/engine/key_type.hpp>
#include <sweepgrid/engine/stable_vector.hpp>
#include <sweepgrid/sap/ids.hpp>

namespace sweepgrid {

/// Client keys by object and objects by key. Calls for different keys may run at once: buckets are sharded by hash, a
/// lock each. A key's hash is kept, so that nothing is asked of a key when its object is erased.
class KeyTable {
 public:
  static constexpr int kShardBits = 6;
  static constexpr std::size_t kShards = std::size_t{1} << kShardBits;

  explicit KeyTable(const KeyType& type) : type_(type), keys_(type.size, type.alignment) {}
  ~KeyTable();
  KeyTable(const KeyTable&) = delete;
  KeyTable& operator=(const KeyTable&) = delete;

  [[nodiscard]] const KeyType& type() const { return type_; }

  /// From store() to release(), also when its object has been erased.
  [[nodiscard]] const void* key(ObjectId object) const { return keys_.address(object); }
  /// How an error message names the object.
  [[nodiscard]] std::string describe(ObjectId object) const { return describe(key(object)); }
  [[nodiscard]] std::string describe(const void* key) const;

  /// kNoObject when unknown. O(1).
  [[nodiscard]] ObjectId find(const void* key) const;

  /// Calls `make` for the new object's id unless the key is known; returns whether it was called. O(1).
  template <class Make>
  bool insert(const void* key, Make&& make) {
    const std::uint32_t hash = hash_of(key);
    Shard& shard = shards_[shard_of(hash)];
    const std::lock_guard lock(shard.mutex);
    shard.buckets.reserve(1);
    return shard.buckets.insert(tag_of(hash), is_key(key), [&] {
      const ObjectId object = make();
      make_room(std::uint64_t{object} + 1);
      store(object, key, hash);
      return object;
    });
  }

  /// Forgets which object has the key; key(object) stays good. Precondition: known. Throws nothing. O(1).
  void erase(ObjectId object);

  // In bulk: first the keys of all objects are stored, then the objects go into the buckets, or out of them, one by one
  // or one shard at a time.

  /// An object of a shard, by item of the call.
  struct Entry {
    std::uint32_t tag;
    std::uint32_t item;
  };
  [[nodiscard]] std::size_t shard_of_object(ObjectId object) const { return shard_of(hashes_[object]); }
  [[nodiscard]] Entry entry(ObjectId object, std::size_t item) const {
    return {tag_of(hashes_[object]), static_cast<std::uint32_t>(item)};
  }

  /// Makes room for keys of objects below `bound`.
  void make_room(std::uint64_t bound);
  /// Copies the key of an object, for which there must be room.
  void store(ObjectId object, const void* key) { store(object, key, hash_of(key)); }
  /// Destroys the copy if there is one. Precondition: no object is known by it. Throws nothing.
  void release(ObjectId object);

  /// Returns whether the key was unknown; only then is the object known by it now. Precondition: store().
  bool insert(ObjectId object);
  /// As above for all entries up to the first whose key is known. `done`: how many went in, also when it throws.
  template <class IdOf>
  void insert_shard(std::size_t index, std::span<const Entry> entries, const IdOf& id_of, std::size_t& done) {
    Shard& shard = shards_[index];
    const std::lock_guard lock(shard.mutex);
    shard.buckets.reserve(entries.size());
    for (const Entry& entry : entries) {
      const ObjectId object = id_of(entry.item);
      if (!shard.buckets.insert(entry.tag, is_key(key(object)), [object] { return object; })) return;
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

  /// Gives back the memory of objects from `bound` on, whose keys must have been released. Not thread-safe.
  void trim(std::uint64_t bound);

  [[nodiscard]] std::size_t bytes() const;

 private:
  struct alignas(64) Shard {
    mutable std::mutex mutex;
    KeyBuckets buckets;
  };

  [[nodiscard]] std::uint32_t hash_of(const void* key) const;
  [[nodiscard]] static std::size_t shard_of(std::uint32_t hash) { return hash >> (32 - kShardBits); }
  [[nodiscard]] static std::uint32_t tag_of(std::uint32_t hash) { return hash << kShardBits; }
  /// Whether an object has the key. No lambda: clang deduces no type of a function that is used further up.
  struct IsKey {
    const KeyTable& table;
    const void* key;
    bool operator()(ObjectId object) const { return table.type_.same(table.keys_.address(object), key); }
  };
  [[nodiscard]] IsKey is_key(const void* key) const { return {*this, key}; }
  void store(ObjectId object, const void* key, std::uint32_t hash);

  const KeyType& type_;
  StableBlocks keys_;                   // by object
  StableVector<std::uint32_t> hashes_;  // by object
  StableVector<std::uint8_t> held_;     // by object: whether there is a key to be destroyed; of types that need it
  std::array<Shard, kShards> shards_;
  std::mutex growth_;
};

}  // namespace sweepgrid
