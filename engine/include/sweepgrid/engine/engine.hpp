#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <sweepgrid/engine/config.hpp>
#include <sweepgrid/engine/engine_core.hpp>
#include <sweepgrid/engine/envelope_filter.hpp>
#include <sweepgrid/engine/envelopes.hpp>
#include <sweepgrid/engine/event_order.hpp>
#include <sweepgrid/engine/events.hpp>
#include <sweepgrid/engine/handle.hpp>
#include <sweepgrid/engine/item_partition.hpp>
#include <sweepgrid/engine/key_order.hpp>
#include <sweepgrid/engine/key_table.hpp>
#include <sweepgrid/engine/stats.hpp>
#include <sweepgrid/engine/step_status.hpp>

namespace sweepgrid {

/// Broad-phase collision detection: objects with closed axis-aligned boxes in, begin and end events out.
///
/// `Scalar`: float, double or an integer type. `Dim`: 1 or more. `Key`: what the client calls its objects, any copyable
/// and hashable type. `Order`: the strict weak order of keys in which events are sorted.
/// float, double, std::int32_t and std::int16_t in 2 and 3 dimensions are compiled into the library; include
/// <sweepgrid/engine/engine_core.inl.hpp> to use others.
///
/// Guarantee: the pairs are exactly those of the boxes as given, closed, after each step, for every type, extents and
/// distance; unless Config::envelope trades that for time, which says what it leaves. What rounds a client's boxes to
/// a type (round_outward(), Quantizer) leaves a superset.
///
/// Thread-safety: calls that queue (insert, update, erase) may run at once from many threads as long as no two of them
/// concern the same object. All other calls want the engine for themselves.
///
/// Errors: bad input throws std::invalid_argument (or std::length_error at the limit of 2^32 - 1 objects) with a
/// message that names the object, and leaves the engine as it was. A bulk call applies wholly or not at all, and names
/// the first bad object.
///
/// Bulk calls for many objects (some ten thousands) run on the engine's workers. Objects, handles, events and counters
/// are then the same as those of one call for each in the same order.
template <class Scalar, int Dim, class Key = std::uint64_t, class Hash = std::hash<Key>, class Order = KeyOrder<Key>>
class Engine {
 public:
  using BoxType = Box<Scalar, Dim>;
  using Displacement = std::array<double, static_cast<std::size_t>(Dim)>;

  /// Throws std::invalid_argument that names the setting when one is out of its range.
  explicit Engine(Config config = {});

  /// Queues a new object; it takes part from the next step() on. The handle is good at once.
  /// Errors: `key` names a live object; `box` has a NaN or min > max. O(1).
  Handle insert(const Key& key, const BoxType& box);
  /// As above for keys[i], boxes[i]; handles are returned in order. Also an error: a key twice in `keys`. The fastest
  /// way to insert many. O(n / workers), and what is serial is short.
  std::vector<Handle> insert(std::span<const Key> keys, std::span<const BoxType> boxes);
  /// As the first, with a margin of the object's own (EnvelopeOptions::margin). Also errors: Config::envelope is
  /// absent; the margin is negative or not finite.
  Handle insert(const Key& key, const BoxType& box, double margin);

  /// Queues a new box. The last update before a step wins. An update to the box that the object has costs nothing more.
  /// Errors: a stale handle, an unknown key, an erased object, a bad box. A handle of another engine is recognised only
  /// where no object of this one has its index and generation. O(1).
  void update(Handle object, const BoxType& box);
  void update(const Key& key, const BoxType& box);
  /// As above for objects[i], boxes[i], in order: the last of several for one object wins. The fastest way to move
  /// many, above all with objects in the order of their handles' indices, or boxes that are queued for the first time
  /// since the latest step. O(n / workers).
  void update(std::span<const Handle> objects, std::span<const BoxType> boxes);
  /// As the first, for an object that will have moved by `ahead` (world units) at the next step: what it covers
  /// meanwhile takes part. Also errors: EnvelopeOptions::swept is off; `ahead` is not finite.
  void update(Handle object, const BoxType& box, const Displacement& ahead);

  /// The margin of the object's later envelopes; one that is much too wide is made anew at the next step. Errors: a
  /// stale handle; as insert() with a margin.
  void set_margin(Handle object, double margin);

  /// Queues the end of an object: the next step() ends all its pairs. Its handle is stale and its key free at once.
  /// An object inserted and erased before the same step leaves no trace. Errors: as update. O(1).
  void erase(Handle object);
  void erase(const Key& key);
  /// Also an error: an object twice in `objects`. O(n / workers).
  void erase(std::span<const Handle> objects);

  /// Applies all that was queued and returns the net change of the set of overlapping pairs since the last step: the
  /// same events in the same order for any thread count, cell kind, grid and order of queueing calls.
  /// The reference stays good, and its content unchanged, until the next step(). O(u + e) beside the cells' work.
  ///
  /// A step beyond Config::step_bytes is refused: no events, status() says so, pairs() are those of the latest step
  /// that was done, and all that was queued is still queued. It goes through once the client has erased or moved
  /// objects, or has raised the limit. The cells are made anew, so a refused step costs about as much as inserting all
  /// objects.
  ///
  /// Throws only what allocation throws, and then leaves everything as a refused step does; pairs() throws
  /// std::logic_error if there was no memory for the cells either, until another step(). Two cases are not covered:
  /// with EnvelopeOptions::exact, the engine can only be destroyed after that, and oneTBB's own allocations must not
  /// fail.
  const Events<Key>& step();

  /// What became of the latest step() that did not throw; kDone before the first one.
  [[nodiscard]] StepStatus status() const { return status_; }
  /// Config::step_bytes of later steps.
  void set_step_bytes(std::optional<std::uint64_t> bytes) { core_.set_step_bytes(bytes); }

  /// Every overlapping pair as of the latest step, sorted as events are. Built on demand: O(p log p).
  [[nodiscard]] std::vector<Pair<Key>> pairs() const;

  /// Live objects: inserted and not erased, queued ones included.
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] bool contains(const Key& key) const;
  [[nodiscard]] std::optional<Handle> find(const Key& key) const;
  /// The box given last, whether or not a step has seen it. Errors: as update.
  [[nodiscard]] BoxType box(Handle object) const;
  /// What takes part in its place, as of the latest step; before the first one, as it was inserted. Without
  /// Config::envelope it is the box. Errors: as update.
  [[nodiscard]] BoxType envelope(Handle object) const;
  [[nodiscard]] const Key& key(Handle object) const;

  /// Checks every named invariant of the engine and its cells against the boxes; throws InvariantError.
  /// For tests and debugging: O(n log n) and more. Precondition: nothing queued since the latest step.
  void validate() const;

  /// Exact counters, times of the latest step's stages, memory. O(cells).
  [[nodiscard]] Stats stats() const;

  /// Whether the promises of Config::envelope were kept. All zero when that is absent.
  [[nodiscard]] EnvelopeReport envelope_report() const;

  /// Records each task's stage, size, start and duration in later steps. Off at first.
  void record_tasks(bool on);
  /// The tasks of the latest step that had anything to do, if it was recorded.
  [[nodiscard]] const TaskTrace& tasks() const;
  [[nodiscard]] std::vector<std::string> stage_names() const;

 private:
  using Core = EngineCore<Scalar, Dim>;
  using Sorter = EventOrder<Key, Order>;
  enum List : std::size_t { kEnds, kBegins, kLists };

  bool step_core();
  void forget_events();
  void add_order_stages();
  void trim_to_objects();
  void sort_shard(std::size_t list, std::size_t shard);
  [[nodiscard]] std::vector<Pair<Key>>& list(std::size_t list) { return list == kEnds ? events_.ends : events_.begins; }
  [[nodiscard]] Pair<Key> keys_of(PairKey pair) const {
    return Sorter::pair(keys_.key(pair.lower()), keys_.key(pair.upper()));
  }
  // Bulk calls, in bulk.inl.hpp.
  using Objects = typename Core::Objects;
  using Share = typename Objects::Share;
  using NewIds = typename Objects::NewIds;
  using Keys = KeyTable<Key, Hash>;
  using KeyEntries = ItemPartition<typename Keys::Entry>;

  [[nodiscard]] ObjectPartition partition_of(std::span<const Handle> objects) const;
  [[nodiscard]] static std::vector<Share> shares_of(const ObjectPartition& partition);
  [[nodiscard]] static std::vector<Share> shares_of(std::size_t items);
  template <class Body>
  void for_shares(std::vector<Share>& shares, Body&& body);
  [[nodiscard]] static std::optional<std::size_t> first_bad(const std::vector<Share>& shares);
  std::vector<Handle> insert(std::span<const Key> keys, std::span<const BoxType> boxes, const NewIds& ids);
  std::optional<std::size_t> insert_keys(const NewIds& ids, std::span<const std::uint32_t> hashes);
  std::optional<std::size_t> insert_keys_by_shard(const NewIds& ids, std::span<const std::uint32_t> hashes);
  void erase_keys(std::span<const Handle> objects);

  // With Config::envelope, in envelope_calls.inl.hpp.
  using EnvelopesType = Envelopes<Scalar, Dim>;
  using FilterType = EnvelopeFilter<Scalar, Dim>;

  void make_envelopes(const std::optional<EnvelopeOptions>& options);
  Handle insert_with_envelope(const Key& key, const BoxType& box, double margin);
  void update_envelope(Handle object, const BoxType& box);
  void update_envelopes(std::span<const Handle> objects, std::span<const BoxType> boxes);
  std::vector<BoxType> envelopes_of(std::span<const BoxType> boxes);
  void store_envelopes(std::span<const Handle> handles, std::span<const BoxType> boxes,
                       std::span<const BoxType> envelopes);
  void erase_envelopes(const Share& share, std::span<const Handle> objects);
  bool step_with_envelopes();
  void add_envelope_stats(Stats& stats) const;
  void validate_envelopes() const;
  void require_margin(const Key& key, const char* call, double margin) const;
  [[nodiscard]] std::size_t event_lists() const { return filter_ ? filter_->lists() : core_.lists(); }

  [[nodiscard]] ObjectId live(Handle object, const char* call) const;
  [[nodiscard]] ObjectId live(const Key& key, const char* call) const;
  template <class Name>
  static void require_valid(const BoxType& box, const Name& object, const char* call);
  static void require_same_size(std::size_t objects, std::size_t boxes, const char* call);

  Core core_;
  std::unique_ptr<EnvelopesType> envelopes_;  // absent: objects are their boxes
  std::unique_ptr<FilterType> filter_;        // with EnvelopeOptions::exact
  KeyTable<Key, Hash> keys_;
  Events<Key> events_;
  StepStatus status_ = StepStatus::kDone;
  std::array<Sorter, kLists> sorters_;
  /// What the merge stage writes: ranges of one list, then of the other.
  std::array<std::size_t, kLists> ranges_{};
};

}  // namespace sweepgrid

#include <sweepgrid/engine/engine.inl.hpp>
