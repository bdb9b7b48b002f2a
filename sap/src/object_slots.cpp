#include <sweepgrid/sap/object_slots.hpp>

#include <algorithm>
#include <bit>
#include <stdexcept>

namespace sweepgrid {

Slot ObjectSlots::acquire(ObjectId object) {
  if (4 * (size() + 1) > 3 * buckets_.size()) rehash(std::max<std::size_t>(8, 2 * buckets_.size()));
  Slot slot;
  if (!free_.empty()) {
    slot = free_.back();
    free_.pop_back();
    objects_[slot] = object;
  } else {
    if (objects_.size() >= kMaxSlots) throw std::length_error("sweepgrid: more than 2^31 - 1 objects in one cell");
    slot = static_cast<Slot>(objects_.size());
    objects_.push_back(object);
  }
  place(object, slot);
  return slot;
}

void ObjectSlots::release(ObjectId object) {
  const auto mask = static_cast<std::uint32_t>(buckets_.size()) - 1;
  std::uint32_t hole = home(object);
  while (buckets_[hole].object != object) hole = (hole + 1) & mask;
  objects_[buckets_[hole].slot] = kNoObject;
  free_.push_back(buckets_[hole].slot);
  // Backward-shift deletion: later entries of the probe run move up, so no tombstones gather.
  for (std::uint32_t next = (hole + 1) & mask; buckets_[next].object != kNoObject; next = (next + 1) & mask) {
    const std::uint32_t wanted = home(buckets_[next].object);
    if (((next - wanted) & mask) >= ((next - hole) & mask)) {
      buckets_[hole] = buckets_[next];
      hole = next;
    }
  }
  buckets_[hole] = Bucket{};
}

void ObjectSlots::rehash(std::size_t bucket_count) {
  buckets_.assign(bucket_count, Bucket{});
  shift_ = 32 - std::countr_zero(bucket_count);
  for (Slot slot = 0; slot < objects_.size(); ++slot) {
    if (objects_[slot] != kNoObject) place(objects_[slot], slot);
  }
}

void ObjectSlots::place(ObjectId object, Slot slot) {
  const auto mask = static_cast<std::uint32_t>(buckets_.size()) - 1;
  std::uint32_t bucket = home(object);
  while (buckets_[bucket].object != kNoObject) bucket = (bucket + 1) & mask;
  buckets_[bucket] = Bucket{object, slot};
}

}  // namespace sweepgrid
