#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <span>
#include <stdexcept>
#include <vector>

#include <sweepgrid/engine/handle.hpp>
#include <sweepgrid/engine/stable_vector.hpp>
#include <sweepgrid/grid/levels.hpp>
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

  /// What is known of an object, as bits. 0: the id is free.
  enum State : std::uint8_t {
    kLive = 1,
    kInserted = 2,  // since the latest step
    kUpdated = 4,
    kErased = 8,
  };
  static constexpr std::uint8_t kQueued = kInserted | kUpdated | kErased;

  // One object, one cache line, where it fits.
  struct alignas(sizeof(BoxType) <= 24 && sizeof(BoxType) > 8 ? 64 : alignof(std::uint64_t)) Record {
    BoxType box;               // the one given last
    BoxType before;            // the one of the latest step, while an op is queued and after it was applied
    std::uint64_t changed_at;  // the latest step that applied an op to the object, counted from 1
    std::uint32_t generation;
    GridIndex grid;         // where it lives
    GridIndex grid_before;  // where it lived at the start of step `changed_at`
    std::uint8_t change;    // what step `changed_at` did, as bits of State
  };

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

  /// No box was ever wider. Grows on its own; after a step the engine may set it to a lower bound that still holds.
  [[nodiscard]] double widest() const { return widest_.load(std::memory_order_relaxed); }
  void set_widest(double width) { widest_.store(width, std::memory_order_relaxed); }

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

  // By bits: where the host flushes denormals to zero, == would take two of them for one.
  static bool same_bits(const BoxType& a, const BoxType& b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

  void measure(const BoxType& box) {
    const double width = Levels<Scalar, Dim>::width(box);
    double widest = widest_.load(std::memory_order_relaxed);
    while (width > widest && !widest_.compare_exchange_weak(widest, width, std::memory_order_relaxed)) {
    }
  }

  StableVector<Record> records_;
  StableVector<std::uint8_t> states_;
  StableVector<std::uint8_t> marks_;  // by granule
  std::atomic<ObjectId> bound_ = 0;
  std::atomic<std::size_t> live_ = 0;
  std::atomic<bool> queued_ = false;
  std::atomic<double> widest_ = 0;
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
      records_[object].changed_at = 0;
      states_[object] = 0;
      if (object % kGranule == 0) marks_[object / kGranule] = 0;
      bound_.store(object + 1, std::memory_order_release);
    }
  }
  measure(box);
  records_[object].box = box;
  states_[object] = kLive;
  mark(object, kInserted);
  live_.fetch_add(1, std::memory_order_relaxed);
  return handle(object);
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::update(ObjectId object, const BoxType& box) {
  Record& record = records_[object];
  if ((states_[object] & kQueued) == 0) {
    if (same_bits(record.box, box)) return;  // a resting object that its client reports anyway costs nothing more
    record.before = record.box;
    mark(object, kUpdated);
  }
  measure(box);
  record.box = box;
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::erase(ObjectId object) {
  if ((states_[object] & kQueued) == 0) records_[object].before = records_[object].box;
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
