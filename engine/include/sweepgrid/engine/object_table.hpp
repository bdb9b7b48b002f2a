#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <stdexcept>
#include <vector>

#include <sweepgrid/engine/handle.hpp>
#include <sweepgrid/engine/stable_vector.hpp>
#include <sweepgrid/grid/cell_range.hpp>
#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/sap/ids.hpp>

namespace sweepgrid {

/// The objects: boxes, cell ranges, generations, and which of them have a queued op. An op is queued by marking its
/// object, so queueing is O(1) and lock-free, the last update wins, and the order of calls leaves no trace.
///
/// Thread-safety: insert, update, erase and cancel for different objects may run at once; the rest may not.
template <class Scalar, int Dim>
class ObjectTable {
 public:
  using BoxType = Box<Scalar, Dim>;

  struct Record {
    BoxType box;  // the one given last
    CellRange<Dim> range;
    std::uint32_t generation;
  };

  /// What is known of an object, as bits. 0: the id is free.
  enum State : std::uint8_t {
    kLive = 1,
    kInserted = 2,  // since the latest step
    kUpdated = 4,
    kErased = 8,
    kOutside = 16,  // of the grid's bounds
  };
  static constexpr std::uint8_t kQueued = kInserted | kUpdated | kErased;

  /// Objects whose marks are looked for together.
  static constexpr std::uint32_t kGranule = 256;

  /// Throws std::length_error at 2^32 - 1 objects. Precondition: a valid box.
  Handle insert(const BoxType& box);

  /// Precondition of these: `object` is live and not erased.
  void update(ObjectId object, const BoxType& box);
  void erase(ObjectId object);
  /// Takes erase() back.
  void cancel_erase(ObjectId object);
  /// Takes insert() back.
  void cancel_insert(ObjectId object);

  /// Whether the handle names an object that is live and not erased.
  [[nodiscard]] bool good(Handle handle) const {
    return handle.index < bound() && (states_[handle.index] & (kLive | kErased)) == kLive &&
           records_[handle.index].generation == handle.generation;
  }
  [[nodiscard]] Handle handle(ObjectId object) const { return {object, records_[object].generation}; }

  [[nodiscard]] Record& record(ObjectId object) { return records_[object]; }
  [[nodiscard]] const Record& record(ObjectId object) const { return records_[object]; }
  [[nodiscard]] std::uint8_t& state(ObjectId object) { return states_[object]; }
  [[nodiscard]] std::uint8_t state(ObjectId object) const { return states_[object]; }

  /// Ids in use are below this.
  [[nodiscard]] ObjectId bound() const { return bound_.load(std::memory_order_acquire); }
  [[nodiscard]] std::size_t size() const { return live_.load(std::memory_order_relaxed); }
  [[nodiscard]] bool anything_queued() const { return queued_.load(std::memory_order_relaxed); }

  /// Granules and whether they hold a marked object.
  [[nodiscard]] std::uint32_t granules() const { return (bound() + (kGranule - 1)) / kGranule; }
  [[nodiscard]] bool granule_marked(std::uint32_t granule) const { return marks_[granule] != 0; }
  void unmark_granule(std::uint32_t granule) { marks_[granule] = 0; }
  void nothing_queued() { queued_.store(false, std::memory_order_relaxed); }

  /// Makes an erased object's id stale; free_ids() then lets it be reused.
  void retire(ObjectId object) {
    states_[object] = 0;
    ++records_[object].generation;
  }
  void free_ids(std::span<const ObjectId> ids) { free_.insert(free_.end(), ids.begin(), ids.end()); }

  [[nodiscard]] std::size_t bytes() const {
    return records_.bytes() + states_.bytes() + marks_.bytes() + free_.capacity() * sizeof(ObjectId);
  }

 private:
  void mark(ObjectId object, std::uint8_t flag) {
    states_[object] |= flag;
    // Neighbours of different threads share a granule, so these two are atomic; checked first to keep the line shared.
    std::atomic_ref<std::uint8_t> granule(marks_[object / kGranule]);
    if (granule.load(std::memory_order_relaxed) == 0) granule.store(1, std::memory_order_relaxed);
    if (!queued_.load(std::memory_order_relaxed)) queued_.store(true, std::memory_order_relaxed);
  }

  StableVector<Record> records_;
  StableVector<std::uint8_t> states_;
  StableVector<std::uint8_t> marks_;  // by granule
  std::atomic<ObjectId> bound_ = 0;
  std::atomic<std::size_t> live_ = 0;
  std::atomic<bool> queued_ = false;
  std::mutex allocation_;  // guards what follows, and growth
  std::vector<ObjectId> free_;
};

template <class Scalar, int Dim>
Handle ObjectTable<Scalar, Dim>::insert(const BoxType& box) {
  ObjectId object;
  {
    const std::lock_guard lock(allocation_);
    if (!free_.empty()) {
      object = free_.back();
      free_.pop_back();
    } else {
      object = bound();
      if (object == kNoObject) throw std::length_error("sweepgrid: more than 2^32 - 1 objects");
      records_.grow(std::uint64_t{object} + 1);
      states_.grow(std::uint64_t{object} + 1);
      marks_.grow(object / kGranule + std::uint64_t{1});
      records_[object].generation = 0;
      states_[object] = 0;
      if (object % kGranule == 0) marks_[object / kGranule] = 0;
      bound_.store(object + 1, std::memory_order_release);
    }
  }
  records_[object].box = box;
  states_[object] = kLive;
  mark(object, kInserted);
  live_.fetch_add(1, std::memory_order_relaxed);
  return handle(object);
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::update(ObjectId object, const BoxType& box) {
  BoxType& current = records_[object].box;
  if ((states_[object] & kQueued) == 0) {
    if (current == box) return;  // a resting object that its client reports anyway costs nothing more
    mark(object, kUpdated);
  }
  current = box;
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::erase(ObjectId object) {
  mark(object, kErased);
  live_.fetch_sub(1, std::memory_order_relaxed);
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::cancel_erase(ObjectId object) {
  states_[object] &= static_cast<std::uint8_t>(~kErased);
  live_.fetch_add(1, std::memory_order_relaxed);
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::cancel_insert(ObjectId object) {
  live_.fetch_sub(1, std::memory_order_relaxed);
  retire(object);
  const std::lock_guard lock(allocation_);
  free_.push_back(object);
}

}  // namespace sweepgrid
