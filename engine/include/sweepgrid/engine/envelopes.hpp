#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include <sweepgrid/engine/envelope_box.hpp>
#include <sweepgrid/engine/envelope_options.hpp>
#include <sweepgrid/engine/granule_marks.hpp>
#include <sweepgrid/engine/handle.hpp>
#include <sweepgrid/engine/object_speed.hpp>
#include <sweepgrid/engine/object_table.hpp>
#include <sweepgrid/engine/stable_vector.hpp>
#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/sap/high_water.hpp>
#include <sweepgrid/sap/ids.hpp>
#include <sweepgrid/sap/prefetch.hpp>
#include <sweepgrid/scheduler/executor.hpp>

namespace sweepgrid {

/// The boxes that the client gave, by object, and the envelopes that the object table holds in their place. Queueing
/// calls write here and mark what a step has to look at; the step then queues new envelopes with the object table.
///
/// Thread-safety: insert, update, set_margin and erase for different objects may run at once; the rest may not.
template <class Scalar, int Dim>
class Envelopes {
 public:
  using BoxType = Box<Scalar, Dim>;
  using Objects = ObjectTable<Scalar, Dim>;
  using Displacement = std::array<double, static_cast<std::size_t>(Dim)>;

  /// An object's margin when it has none of its own.
  static constexpr double kCommonMargin = -1;

  /// Throws std::invalid_argument that names the setting.
  explicit Envelopes(const EnvelopeOptions& options);

  [[nodiscard]] const EnvelopeOptions& options() const { return options_; }

  /// The envelope for a box when it is made. A box that is not valid is its own, to be refused.
  [[nodiscard]] BoxType envelope_of(const BoxType& box, double margin = kCommonMargin) const;

  /// Makes room for objects below `bound`. Like insert() while others are queued.
  void make_room(std::uint64_t bound);
  /// The object table has given `object` the envelope. Throws nothing where there is room.
  void insert(Handle object, const BoxType& box, const BoxType& envelope, double margin = kCommonMargin);

  /// Precondition of what follows: a good handle, a valid box.
  void update(ObjectId object, const BoxType& box);
  /// The object will have moved by `ahead` at the next step.
  void update(ObjectId object, const BoxType& box, const Displacement& ahead);
  void set_margin(ObjectId object, double margin);
  void erase(ObjectId object);
  /// Takes insert() back.
  void cancel_insert(ObjectId object) { states_[object] = 0; }

  [[nodiscard]] bool good(Handle handle) const {
    return handle.index < records_.size() && (states_[handle.index] & kLive) != 0 &&
           records_[handle.index].generation == handle.generation;
  }
  [[gnu::always_inline]] void prefetch(Handle handle) const {
    if (handle.index < records_.size()) sweepgrid::prefetch(&records_[handle.index]);
  }
  [[nodiscard]] const BoxType& box(ObjectId object) const { return records_[object].box; }
  [[nodiscard]] const BoxType& envelope(ObjectId object) const { return records_[object].envelope; }

  // ---- the step

  /// Decides whether this step is a query, and if it is, queues new envelopes with `objects`: of all objects that need
  /// one, or if the query is early, of those that have left theirs. To be followed by end_step(); if it throws, or the
  /// step cannot be done, by cancel_step().
  bool begin_step(Objects& objects, Executor& executor);
  /// Throws nothing, but what the executor's own allocations throw.
  void end_step(Executor& executor);
  /// As if begin_step() had not been called.
  void cancel_step(Objects& objects) noexcept;

  /// Objects whose marks are looked for together, and which of them held a marked object as the step began.
  static constexpr ObjectId kGranule = Objects::kGranule;
  [[nodiscard]] std::span<const std::uint32_t> granules() const { return granules_; }

  // With `exact`: what changed since the latest step. To be asked from begin_step() to settle(), and between two
  // steps about the latest one.
  [[nodiscard]] bool changed(ObjectId object) const { return (states_[object] & (kChanged | kBorn | kErased)) != 0; }
  [[nodiscard]] bool existed(ObjectId object) const {
    return (states_[object] & (kLive | kErased)) != 0 && (states_[object] & kBorn) == 0;
  }
  [[nodiscard]] bool exists(ObjectId object) const { return (states_[object] & kLive) != 0; }
  [[nodiscard]] const BoxType& before(ObjectId object) const {
    return (states_[object] & kChanged) != 0 ? others_[object] : records_[object].box;
  }
  /// What changed is now as it was at the latest step. `granule`: one of granules().
  void settle(std::uint32_t granule) noexcept;

  [[nodiscard]] ObjectId bound() const { return static_cast<ObjectId>(records_.size()); }
  [[nodiscard]] std::uint64_t steps() const { return report_.steps; }
  /// Whether the latest step was a query.
  [[nodiscard]] bool queried() const { return queried_; }
  [[nodiscard]] EnvelopeReport report() const { return report_; }
  /// Memory in use. O(workers).
  [[nodiscard]] std::size_t bytes() const;

  /// Gives back the memory of objects from `bound` on.
  void trim(std::uint64_t bound);

  /// V1: what the object table holds are the envelopes; and, but for objects that the report names, each holds its box.
  /// Throws InvariantError. Precondition: nothing queued since the latest step.
  void validate(const Objects& objects) const;

 private:
  enum State : std::uint16_t {
    kLive = 1,
    kFresh = 2,      // inserted since the latest query
    kMoved = 4,      // to be looked at: its box changed since the latest query
    kStretched = 8,  // to be looked at: its envelope covers a way
    kAhead = 16,     // it was said where it will go
    kPromised = 32,  // its envelope covers where it was said to go, and no other way
    kChanged = 64,   // since the latest step
    kBorn = 128,     // since the latest step
    kErased = 256,   // since the latest step
  };

  // One object, one cache line, where it fits.
  struct alignas(sizeof(BoxType) <= 24 && sizeof(BoxType) > 8 ? 64 : alignof(double)) Record {
    BoxType box;
    BoxType envelope;  // what the object table was told last
    std::uint32_t generation;
    float margin;  // kCommonMargin: the common one
  };

  /// An object that a query looks at, and its state once the query is made.
  struct Seen {
    ObjectId object;
    std::uint16_t state;
  };

  /// What a scan finds in a part of the granules.
  struct Block {
    std::vector<ObjectId> outside;
    std::vector<Seen> seen;
    std::vector<std::pair<ObjectId, BoxType>> first;  // envelopes that no query knew, and that were made anew
    double margin = -1;                               // the widest of new envelopes with the common rule
    std::array<HighWater, 3> water;                   // of the lists
  };

  [[nodiscard]] static double rounded(double margin) { return std::is_integral_v<Scalar> ? std::ceil(margin) : margin; }
  /// For queueing calls, and for the step that they are for.
  [[nodiscard]] double margin_of(ObjectId object) const {
    const double own = records_[object].margin;
    if (own >= 0) return rounded(own);
    return rounded(options_.margin_steps > 0 ? common_margin(speeds_[object].at(now(), fade_)) : options_.margin);
  }
  [[nodiscard]] double common_margin(double speed) const { return options_.margin + options_.margin_steps * speed; }
  [[nodiscard]] bool fits(ObjectId object) const {
    const Record& record = records_[object];
    return holds(record.envelope, record.box) && !loose(record.envelope, record.box, margin_of(object));
  }
  [[nodiscard]] static bool loose(const BoxType& envelope, const BoxType& needed, double margin) {
    return slack(envelope, needed) > kLoose * margin;
  }

  /// The step that is being queued, or that is running.
  [[nodiscard]] std::uint32_t now() const { return static_cast<std::uint32_t>(report_.steps); }
  void note_displacement(ObjectId object, const BoxType& box) {
    if (options_.margin_steps > 0) speeds_[object].note(displacement(records_[object].box, box), now(), fade_);
  }
  void mark(ObjectId object);
  /// Those of the latest scan.
  [[nodiscard]] std::span<Block> blocks() { return std::span(blocks_).first(blocks_used_); }
  void collect_granules();
  template <class Visit>
  void scan(Executor& executor, Visit&& visit);
  void check(ObjectId object, Objects& objects, Block& out);
  void renew(ObjectId object, Objects& objects, Block& out);
  void recycle();
  template <class Body>
  void for_blocks(Executor& executor, Body&& body);

  /// An envelope by which a box is narrower by more than so many margins is made anew; when it is made, they are 2.
  static constexpr double kLoose = 6;

  EnvelopeOptions options_;
  bool tracks_;  // whether every change is marked, or only those that leave their envelope
  double fade_;  // of speeds
  StableVector<Record> records_;
  StableVector<std::uint16_t> states_;
  GranuleMarks marks_;
  // exact: the box of the latest step, of what has changed. swept: the other end of the way.
  StableVector<BoxType> others_;
  StableVector<ObjectSpeed> speeds_;  // with margin_steps
  std::mutex growth_;
  std::atomic<bool> marked_ = false;

  int age_;               // steps since the latest query that was not early
  bool queried_ = false;  // the latest step was a query
  // This step:
  bool query_ = false;
  bool early_ = false;  // because of a violation
  std::vector<std::uint32_t> granules_;
  HighWater granules_water_;
  std::vector<Block> blocks_;  // never fewer than before
  std::size_t blocks_used_ = 0;
  std::vector<Handle> outside_;
  HighWater outside_water_;
  EnvelopeReport report_;
};

}  // namespace sweepgrid
