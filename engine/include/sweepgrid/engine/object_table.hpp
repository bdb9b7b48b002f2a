#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <mutex>
#include <new>
#include <span>
#include <stdexcept>
#include <vector>

#include <sweepgrid/engine/granule_marks.hpp>
#include <sweepgrid/engine/handle.hpp>
#include <sweepgrid/engine/item_partition.hpp>
#include <sweepgrid/engine/stable_vector.hpp>
#include <sweepgrid/grid/levels.hpp>
#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/sap/ids.hpp>
#include <sweepgrid/sap/prefetch.hpp>

namespace sweepgrid {

/// The objects: boxes, cell ranges, generations, and which of them have a queued op. An op is queued by marking its
/// object, so queueing is O(1) and lock-free, the last update wins, and the order of calls leaves no trace.
///
/// Thread-safety: insert, update, erase and cancel for different objects may run at once; the rest may not.
template <class Scalar, int Dim>
class ObjectTable {
 public:
  using BoxType = Box<Scalar, Dim>;
  using Width = typename Levels<Scalar, Dim>::Real;

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
  /// Takes insert() back.
  void cancel_insert(ObjectId object);

  /// Returns whether it is done; else the handle is not good or the box not valid.
  bool update(Handle object, const BoxType& box);
  /// Precondition: `object` is live and not erased.
  void erase(ObjectId object);

  /// One worker's share of a bulk call, and how far it has come.
  struct Share {
    Items items;
    std::size_t done = 0;     // items [0, done) are applied
    std::size_t checked = 0;  // items [done, checked) can be; if there are more, the next one cannot
    Width widest = 0;         // of the boxes applied, or what no box was wider than
    bool queued = false;      // an op
  };

  /// Ids of a bulk insert, by item.
  class NewIds {
   public:
    [[nodiscard]] bool fresh(std::size_t item) const { return item >= reused_.size(); }
    [[nodiscard]] ObjectId operator[](std::size_t item) const {
      return fresh(item) ? first_ + static_cast<ObjectId>(item - reused_.size()) : reused_[item];
    }

   private:
    friend class ObjectTable;
    std::vector<ObjectId> reused_;
    ObjectId first_ = 0;
    std::size_t count_ = 0;
  };

  // Bulk calls: first every share is begun, at once if no two concern the same object; if all that they are
  // to do can be done, each is finished, else each is taken back. The engine is then as it was, but for granules marked
  // without a need: always those of all the objects that the call names.

  /// Ids in the order in which as many calls of insert() would give them. Throws as insert().
  NewIds reserve(std::size_t count);
  void begin_insert(Share& share, const NewIds& ids, std::span<const BoxType> boxes, std::span<Handle> handles);
  void finish_insert(const Share& share);
  void cancel_insert(const NewIds& ids);

  /// Applies items up to the first object that has a queued op already, for its box could not be told when taken back.
  /// Of the others, only checks that the handle and the box are good.
  void begin_update(Share& share, std::span<const Handle> objects, std::span<const BoxType> boxes);
  void finish_update(Share& share, std::span<const Handle> objects, std::span<const BoxType> boxes);
  void cancel_update(const Share& share, std::span<const Handle> objects);

  /// Good are handles that are good and have not come before.
  void begin_erase(Share& share, std::span<const Handle> objects);
  void finish_erase(const Share& share);
  void cancel_erase(const Share& share, std::span<const Handle> objects);

  /// Whether the handle names an object that is live and not erased.
  [[nodiscard]] bool good(Handle handle) const { return handle.index < bound() && is(handle); }
  [[nodiscard]] Handle handle(ObjectId object) const { return {object, records_[object].generation}; }

  [[nodiscard]] Record& record(ObjectId object) { return records_[object]; }
  [[nodiscard]] const Record& record(ObjectId object) const { return records_[object]; }
  [[nodiscard]] std::uint8_t& state(ObjectId object) { return states_[object]; }
  [[nodiscard]] std::uint8_t state(ObjectId object) const { return states_[object]; }

  /// Ids in use are below this.
  [[nodiscard]] ObjectId bound() const { return bound_.load(std::memory_order_acquire); }
  [[nodiscard]] std::size_t size() const { return live_.load(std::memory_order_relaxed); }
  /// Chooses objects at random, but always the same, from runs of the same length of all that are not erased; as many
  /// as there is room for, if there are. Returns them in the order of ids. O(bound()), of bytes.
  [[nodiscard]] std::span<const ObjectId> sample(std::span<ObjectId> room) const;
  /// Of the `i`th of `runs` equal runs of all numbers below `end`, one at random, but always the same. Who would take
  /// the same one of each run might see nothing but every 16th object, which is of another kind.
  [[nodiscard]] static std::uint64_t any_of_run(std::uint64_t i, std::uint64_t runs, std::uint64_t end) {
    const std::uint64_t first = i * end / runs;
    const std::uint64_t length = (i + 1) * end / runs - first;
    return length == 0 ? first : first + (i * 0x9e3779b97f4a7c15U >> 32) % length;
  }
  [[nodiscard]] bool anything_queued() const { return queued_.load(std::memory_order_relaxed); }

  /// No box was ever wider. Grows on its own; after a step the engine may set it to a lower bound that still holds.
  [[nodiscard]] double widest() const { return widest_.load(std::memory_order_relaxed); }
  void set_widest(double width) {
    auto rounded = static_cast<Width>(width);
    if (rounded < width) rounded = std::nextafter(rounded, std::numeric_limits<Width>::infinity());
    widest_.store(rounded, std::memory_order_relaxed);
  }

  /// Granules and whether they hold a marked object.
  [[nodiscard]] std::uint32_t granules() const { return granules_of(bound()); }
  [[nodiscard]] static std::uint32_t granules_of(ObjectId bound) {  // without a sum that could overflow
    return bound / kGranule + (bound % kGranule != 0 ? 1 : 0);
  }
  [[nodiscard]] bool granule_marked(std::uint32_t granule) const { return marks_.marked(granule); }
  void unmark_granule(std::uint32_t granule) { marks_.unmark(granule); }
  /// Calls `visit(granule)` for every one that is marked, in their order. O(granules that are marked + granules / 64).
  template <class Visit>
  void for_each_marked(Visit&& visit) {
    marks_.for_each(granules(), visit);
  }
  /// What was queued for the objects of a granule is done, but for retire().
  void settle(std::uint32_t granule) {
    if (!granule_marked(granule)) return;
    unmark_granule(granule);
    const ObjectId first = granule * kGranule;
    std::uint8_t* const states = &states_[first];  // a granule is contiguous
    const std::uint32_t count = std::min(bound() - first, kGranule);
    for (std::uint32_t i = 0; i < count; ++i) states[i] &= kLive;
  }
  void nothing_queued() {
    queued_.store(false, std::memory_order_relaxed);
    ++latest_generation_;
  }

  /// Makes an erased object's id stale; free_ids() then lets it be reused.
  void retire(ObjectId object) {
    set_state(object, 0);
    set_generation(object, records_[object].generation + 1);
  }
  /// Ids that objects to come will have, the next one last. Those that free_ids() adds stand at the end.
  [[nodiscard]] std::span<const ObjectId> free_ids() const { return free_; }
  /// Throws nothing after reserve_free() for as many.
  void free_ids(std::span<const ObjectId> ids) { free_.insert(free_.end(), ids.begin(), ids.end()); }
  void reserve_free(std::size_t ids) {
    if (free_.size() + ids > free_.capacity()) free_.reserve(std::max(free_.size() + ids, 2 * free_.capacity()));
  }

  /// Queues again what a step that is taken back has applied to the object, retire() included: `change` is its state as
  /// the step began.
  void requeue(ObjectId object, std::uint8_t change) {
    if (states_[object] == 0) --records_[object].generation;
    states_[object] = change;
    records_[object].changed_at = 0;
    mark(object);
  }
  /// Sees to it that a step looks at the object.
  void mark(ObjectId object) {
    mark_granule(object / kGranule);
    something_queued();
  }

  /// To be called when nothing is queued. When few objects are left, lowers bound() below the free ids at the top and
  /// gives their memory back; returns whether it did. Handles of what lived there stay stale. O(1), seldom O(bound()).
  bool trim();

  /// Heap bytes held.
  [[nodiscard]] std::size_t bytes() const {
    return records_.bytes() + states_.bytes() + marks_.bytes() + free_.capacity() * sizeof(ObjectId);
  }

  /// By bits: where the host flushes denormals to zero, == would take two of them for one.
  [[nodiscard]] static bool same_bits(const BoxType& a, const BoxType& b) {
    constexpr std::size_t kWord = sizeof(std::uint64_t);
    if constexpr (sizeof(BoxType) % kWord != 0) return std::memcmp(&a, &b, sizeof(a)) == 0;
    std::uint64_t differing = 0;
    for (std::size_t byte = 0; byte < sizeof(BoxType); byte += kWord) {
      std::uint64_t x;
      std::uint64_t y;
      std::memcpy(&x, reinterpret_cast<const char*>(&a) + byte, kWord);
      std::memcpy(&y, reinterpret_cast<const char*>(&b) + byte, kWord);
      differing |= x ^ y;
    }
    return differing == 0;
  }

 private:
  // Stale handles may be tried while other threads give their slots to new objects. So the state and the generation are
  // atomic: plain loads and stores all the same. The state of a live object is written after its generation.
  [[nodiscard]] bool is(Handle handle) const {
    const auto state = load(states_[handle.index], std::memory_order_acquire);
    return (state & (kLive | kErased)) == kLive &&
           load(records_[handle.index].generation, std::memory_order_relaxed) == handle.generation;
  }
  template <class T>
  [[nodiscard]] static T load(const T& value, std::memory_order order) {
    return std::atomic_ref<T>(const_cast<T&>(value)).load(order);
  }
  void set_state(ObjectId object, std::uint8_t state) {
    std::atomic_ref(states_[object]).store(state, std::memory_order_release);
  }
  void set_generation(ObjectId object, std::uint32_t generation) {
    std::atomic_ref(records_[object].generation).store(generation, std::memory_order_relaxed);
  }

  [[gnu::always_inline]] void mark_granule(std::uint32_t granule) { marks_.mark(granule); }
  void something_queued() {
    if (!queued_.load(std::memory_order_relaxed)) queued_.store(true, std::memory_order_relaxed);
  }
  void mark_all(const Share& share, std::span<const Handle> objects);

  // Sees to it that the records of items a little ahead are on their way to the cache; of a list, also what is to be
  // known of them first. Inline, or else the compiler takes it for a function without effect.
  [[gnu::always_inline]] void prefetch(const Items& items, std::size_t i, std::span<const Handle> objects,
                                       const BoxType* boxes, ObjectId end) {
    constexpr std::size_t kAhead = 12;
    if (i + kAhead >= items.size()) return;
    const std::size_t item = items[i + kAhead];
    if (objects[item].index < end) sweepgrid::prefetch(&records_[objects[item].index]);
    if (!items.listed()) return;
    if (boxes != nullptr) sweepgrid::prefetch(&boxes[item]);
    if (i + 2 * kAhead < items.size()) sweepgrid::prefetch(&objects[items[i + 2 * kAhead]]);
  }

  [[gnu::always_inline]] bool replace(ObjectId object, const BoxType& box);

  ObjectId extend(std::size_t count);
  // To undo a call must not fail: where there is no memory, the id is not used again.
  void free_after_failure(ObjectId object) noexcept {
    try {
      free_.push_back(object);
    } catch (const std::bad_alloc&) {
    }
  }
  void occupy(ObjectId object, bool fresh, const BoxType& box);
  void renew(ObjectId object) {
    set_generation(object, first_generation_);
    records_[object].changed_at = 0;
  }

  using WidthLevels = Levels<Scalar, Dim>;
  [[gnu::always_inline]] static void widen(Width& widest, const BoxType& box) {
    if (WidthLevels::wider(box, widest)) [[unlikely]]
      widest = WidthLevels::width(box);
  }
  void measure(Width width) {
    Width widest = widest_.load(std::memory_order_relaxed);
    while (width > widest && !widest_.compare_exchange_weak(widest, width, std::memory_order_relaxed)) {
    }
  }

  StableVector<Record> records_;
  StableVector<std::uint8_t> states_;
  GranuleMarks marks_;
  std::atomic<ObjectId> bound_ = 0;
  std::atomic<std::size_t> live_ = 0;
  std::atomic<bool> queued_ = false;
  std::atomic<Width> widest_ = 0;
  // Every generation is at most this: at most one retirement for an object and a step. A fresh record begins with what
  // it was when records were given back, so that no handle of theirs can be good again.
  std::uint32_t latest_generation_ = 0;
  std::uint32_t first_generation_ = 0;
  std::size_t trim_at_ = 0;  // number of objects left at which trim() looks next
  std::mutex allocation_;    // guards what follows, and growth
  std::vector<ObjectId> free_;
};

}  // namespace sweepgrid

#include <sweepgrid/engine/object_table.inl.hpp>
