#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <sweepgrid/sap/endpoint.hpp>
#include <sweepgrid/sap/ids.hpp>
#include <sweepgrid/sap/prefetch.hpp>

namespace sweepgrid {

/// The objects of one cell and their slots: the paper's "integer key for each cell" (section 3.1), found by hashing
/// inside the cell. A slot is stable until released; released slots are reused, so slots stay dense.
class ObjectSlots {
 public:
  static constexpr Slot kAbsent = 0xffffffffU;

  /// Slot of `object`, or kAbsent. O(1).
  [[nodiscard]] Slot find(ObjectId object) const {
    if (buckets_.empty()) return kAbsent;
    const std::uint32_t mask = static_cast<std::uint32_t>(buckets_.size()) - 1;
    for (std::uint32_t bucket = home(object);; bucket = (bucket + 1) & mask) {
      const Bucket& entry = buckets_[bucket];
      if (entry.object == object) return entry.slot;
      if (entry.object == kNoObject) return kAbsent;
    }
  }

  /// Gives `object` a slot. Precondition: absent. Throws std::length_error beyond kMaxSlots.
  Slot acquire(ObjectId object);

  /// Takes the slot of `object` back. Precondition: present.
  void release(ObjectId object);

  /// Owner of a slot in use; kNoObject for a free one.
  [[nodiscard]] ObjectId object(Slot slot) const { return objects_[slot]; }

  [[nodiscard]] std::size_t size() const { return objects_.size() - free_.size(); }

  /// Slots in use are below this.
  [[nodiscard]] std::size_t slot_bound() const { return objects_.size(); }

  void prefetch() const { sweepgrid::prefetch(buckets_.data(), buckets_.size() * sizeof(Bucket)); }

  [[nodiscard]] std::size_t bytes() const {
    return buckets_.capacity() * sizeof(Bucket) + (objects_.capacity() + free_.capacity()) * sizeof(std::uint32_t);
  }

 private:
  struct Bucket {
    ObjectId object = kNoObject;
    Slot slot = kAbsent;
  };

  // Fibonacci hashing: ids that follow each other land far apart.
  [[nodiscard]] std::uint32_t home(ObjectId object) const { return object * 0x9e3779b9U >> shift_; }
  void rehash(std::size_t bucket_count);
  void place(ObjectId object, Slot slot);

  std::vector<Bucket> buckets_;  // open addressing, linear probing, a power of two, at most 3/4 full
  int shift_ = 32;               // 32 - log2(bucket count)
  std::vector<ObjectId> objects_;
  std::vector<Slot> free_;
};

}  // namespace sweepgrid
