#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <sweepgrid/engine/config.hpp>
#include <sweepgrid/engine/events.hpp>
#include <sweepgrid/engine/handle.hpp>
#include <sweepgrid/engine/key_order.hpp>
#include <sweepgrid/engine/key_type.hpp>
#include <sweepgrid/engine/keyed_engine.hpp>
#include <sweepgrid/engine/stats.hpp>
#include <sweepgrid/engine/step_status.hpp>

namespace sweepgrid {

/// Broad-phase collision detection: objects with closed axis-aligned boxes in, begin and end events out.
///
/// `Scalar`: float, double or an integer type. `Dim`: 1 or more. `Key`: what the client calls its objects, any type
/// that can be copied, hashed (std::hash, or `Hash`) and compared (==). `Order`: the total order of keys in which
/// events are sorted: for distinct keys, one must come before the other. step() and pairs() refuse keys that it holds
/// to be equal. Neither needs a default constructor. Keys are copied at insert(); the copy is destroyed by the step
/// that applies the object's erase, those in event lists by the next step.
///
/// float, double, std::int32_t and std::int16_t in 2 and 3 dimensions are compiled into the library; include
/// <sweepgrid/engine/keyed_engine.inl.hpp> to use others. An engine can be moved, not copied; one that was moved from
/// can only be destroyed or assigned to.
///
/// Guarantee: the pairs are exactly those of the boxes as given, closed, after each step, for every type, extents and
/// distance; unless Config::envelope trades that for time, which says what it leaves. What rounds a client's boxes to
/// a type (round_outward(), Quantizer) leaves a superset.
///
/// Thread-safety: calls that queue (insert, update, erase) may run at once from many threads as long as no two of them
/// concern the same object; a stale handle concerns none, and is refused. All other calls want the engine for
/// themselves. A call that comes while step() runs throws std::logic_error.
///
/// Errors: bad input throws std::invalid_argument (or std::length_error at the limit of 2^32 - 1 objects) with a
/// message that names the object, and leaves the engine as it was; so does what allocating, or copying, hashing or
/// comparing a key throws. A bulk call applies wholly or not at all, and names the first bad object.
///
/// Bulk calls for many objects (some ten thousands) run on the engine's workers. Objects, handles, events and counters
/// are then the same as those of one call for each in the same order.
template <class Scalar, int Dim, class Key = std::uint64_t, class Hash = std::hash<Key>, class Order = KeyOrder<Key>>
class Engine {
 public:
  using BoxType = Box<Scalar, Dim>;
  using Displacement = std::array<double, static_cast<std::size_t>(Dim)>;

  /// Throws std::invalid_argument that names the setting when one is out of its range.
  explicit Engine(Config config = {})
      : events_(std::make_unique<Events<Key>>()),
        engine_(std::move(config), key_type::of<Key, Hash, Order>(), {&events_->ends, &events_->begins}) {}

  /// Queues a new object; it takes part from the next step() on. The handle is good at once.
  /// Errors: `key` names a live object; `box` has a NaN or min > max. O(1).
  Handle insert(const Key& key, const BoxType& box) { return engine_.insert(&key, box); }
  /// As above for keys[i], boxes[i]; handles are returned in order. Also an error: a key twice in `keys`. The fastest
  /// way to insert many. O(n / workers), and what is serial is short.
  std::vector<Handle> insert(std::span<const Key> keys, std::span<const BoxType> boxes) {
    return engine_.insert(keys.data(), keys.size(), boxes);
  }
  /// As the first, with a margin of the object's own (EnvelopeOptions::margin). Also errors: Config::envelope is
  /// absent; the margin is negative or not finite.
  Handle insert(const Key& key, const BoxType& box, double margin) { return engine_.insert(&key, box, margin); }

  /// Queues a new box. The last update before a step wins. An update to the box that the object has costs nothing more.
  /// Errors: a stale handle, an unknown key, an erased object, a bad box. A handle of another engine is recognised only
  /// where no object of this one has its index and generation. O(1).
  void update(Handle object, const BoxType& box) { engine_.update(object, box); }
  void update(const Key& key, const BoxType& box) { engine_.update(&key, box); }
  /// As above for objects[i], boxes[i], in order: the last of several for one object wins. The fastest way to move
  /// many, above all with objects in the order of their handles' indices, or boxes that are queued for the first time
  /// since the latest step. O(n / workers).
  void update(std::span<const Handle> objects, std::span<const BoxType> boxes) { engine_.update(objects, boxes); }
  /// As the first, for an object that will have moved by `ahead` (world units) at the next step: what it covers
  /// meanwhile takes part. Also errors: EnvelopeOptions::swept is off; `ahead` is not finite.
  void update(Handle object, const BoxType& box, const Displacement& ahead) { engine_.update(object, box, ahead); }

  /// The margin of the object's later envelopes; one that is much too wide is made anew at the next step. Errors: a
  /// stale handle; as insert() with a margin.
  void set_margin(Handle object, double margin) { engine_.set_margin(object, margin); }

  /// Queues the end of an object: the next step() ends all its pairs. Its handle is stale and its key free at once.
  /// An object inserted and erased before the same step leaves no trace. Errors: as update. O(1).
  void erase(Handle object) { engine_.erase(object); }
  void erase(const Key& key) { engine_.erase(&key); }
  /// Also an error: an object twice in `objects`. O(n / workers).
  void erase(std::span<const Handle> objects) { engine_.erase(objects); }

  /// Applies all that was queued and returns the net change of the set of overlapping pairs since the last step: the
  /// same events in the same order for any thread count, cell kind, grid and order of queueing calls.
  /// The reference stays good, and its content unchanged, until the next step(). O(u + e) beside the cells' work.
  ///
  /// A step beyond Config::step_bytes is refused: no events, status() says so, pairs() are those of the latest step
  /// that was done, and all that was queued is still queued. It goes through once the client has erased or moved
  /// objects, or has raised the limit. The cells are made anew, so a refused step costs about as much as inserting all
  /// objects.
  ///
  /// Throws what allocation throws, what copying or comparing keys throws, and std::invalid_argument that names two
  /// objects whose keys `Order` holds to be equal; and then leaves everything as a refused step does. oneTBB's own
  /// allocations must not fail.
  const Events<Key>& step() {
    engine_.step();
    return *events_;
  }

  /// What became of the latest step() that did not throw; kDone before the first one.
  [[nodiscard]] StepStatus status() const { return engine_.status(); }
  /// Config::step_bytes of later steps.
  void set_step_bytes(std::optional<std::uint64_t> bytes) { engine_.set_step_bytes(bytes); }

  /// Every overlapping pair as of the latest step, sorted as events are. Built on demand: O(p log p).
  [[nodiscard]] std::vector<Pair<Key>> pairs() const {
    std::vector<Pair<Key>> pairs;
    engine_.pairs(&pairs);
    return pairs;
  }

  /// Live objects: inserted and not erased, queued ones included.
  [[nodiscard]] std::size_t size() const { return engine_.size(); }
  [[nodiscard]] bool contains(const Key& key) const { return engine_.contains(&key); }
  [[nodiscard]] std::optional<Handle> find(const Key& key) const { return engine_.find(&key); }
  /// The box given last, whether or not a step has seen it. Errors: as update.
  [[nodiscard]] BoxType box(Handle object) const { return engine_.box(object); }
  /// What takes part in its place, as of the latest step; before the first one, as it was inserted. Without
  /// Config::envelope it is the box. Errors: as update.
  [[nodiscard]] BoxType envelope(Handle object) const { return engine_.envelope(object); }
  /// The reference stays good until the step that applies the object's erase.
  [[nodiscard]] const Key& key(Handle object) const { return *static_cast<const Key*>(engine_.key(object)); }

  /// Checks every named invariant of the engine and its cells against the boxes; throws InvariantError.
  /// For tests and debugging: O(n log n) and more. Precondition: nothing queued since the latest step.
  void validate() const { engine_.validate(); }

  /// Exact counters, times of the latest step's stages, memory. O(cells).
  [[nodiscard]] Stats stats() const { return engine_.stats(); }

  /// Whether the promises of Config::envelope were kept. All zero when that is absent.
  [[nodiscard]] EnvelopeReport envelope_report() const { return engine_.envelope_report(); }

  /// Records each task's stage, size, start and duration in later steps. Off at first.
  void record_tasks(bool on) { engine_.record_tasks(on); }
  /// The tasks of the latest step that had anything to do, if it was recorded.
  [[nodiscard]] const TaskTrace& tasks() const { return engine_.tasks(); }
  [[nodiscard]] std::vector<std::string> stage_names() const { return engine_.stage_names(); }

 private:
  std::unique_ptr<Events<Key>> events_;  // the engine writes to them, wherever the engine moves
  KeyedEngine<Scalar, Dim> engine_;
};

}  // namespace sweepgrid
