#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include <sweepgrid/engine/describe.hpp>
#include <sweepgrid/engine/engine_core.inl.hpp>
#include <sweepgrid/engine/envelope_filter.inl.hpp>
#include <sweepgrid/engine/envelopes.inl.hpp>
#include <sweepgrid/engine/event_order.hpp>
#include <sweepgrid/engine/item_partition.hpp>
#include <sweepgrid/engine/key_table.hpp>
#include <sweepgrid/engine/keyed_engine.hpp>
#include <sweepgrid/sap/invariant.hpp>
#include <sweepgrid/scheduler/floating_point_mode.hpp>

namespace sweepgrid {

template <class Scalar, int Dim>
struct KeyedEngine<Scalar, Dim>::Parts {
  using Core = EngineCore<Scalar, Dim>;
  using Objects = typename Core::Objects;
  using EnvelopesType = Envelopes<Scalar, Dim>;

  Parts(Config config, const KeyType& type, EventLists lists)
      : core(config, sizeof(PairKey) + 2 * type.pair_size),
        envelopes(config.envelope ? std::make_unique<EnvelopesType>(*config.envelope) : nullptr),
        filter(envelopes && config.envelope->exact ? std::make_unique<EnvelopeFilter<Scalar, Dim>>(core, *envelopes)
                                                   : nullptr),
        keys(type),
        events(lists),
        order(keys, {[this] { return filter ? filter->lists() : core.lists(); },
                     [this](EventOrder::List list, std::size_t i) { return found(list, i); },
                     [this] { return objects().bound(); }}) {
    order.write_to({events.ends, events.begins});
    if (filter) {
      order.add_stages(filter->graph(), filter->last_stage(), core.executor());
    } else {
      order.add_stages(core.graph(), core.last_stage(), core.executor());
    }
  }

  [[nodiscard]] Objects& objects() { return core.objects(); }
  [[nodiscard]] std::span<const PairKey> found(EventOrder::List list, std::size_t i) const {
    if (filter) return list == EventOrder::kEnds ? filter->ends(i) : filter->begins(i);
    return list == EventOrder::kEnds ? core.ends(i) : core.begins(i);
  }
  [[nodiscard]] const Objects& objects() const { return core.objects(); }

  // Bulk calls, in bulk.inl.hpp.
  using Share = typename Objects::Share;
  using NewIds = typename Objects::NewIds;
  using KeyEntries = ItemPartition<KeyTable::Entry>;

  [[nodiscard]] ObjectPartition partition_of(std::span<const Handle> objects_of_call) const;
  template <class Body>
  void for_shares(std::vector<Share>& shares, Body&& body) const;
  [[nodiscard]] std::optional<std::size_t> insert_keys(const NewIds& ids, std::size_t count);
  [[nodiscard]] std::optional<std::size_t> insert_keys_by_shard(const NewIds& ids, std::size_t count);
  void cancel_insert(const NewIds& ids, std::size_t count) noexcept;
  void erase_keys(std::span<const Handle> objects_of_call);

  [[nodiscard]] std::size_t begins() const { return keys.type().list_size(events.begins); }
  [[nodiscard]] std::size_t ends() const { return keys.type().list_size(events.ends); }

  std::atomic<bool> stepping = false;
  Core core;
  std::unique_ptr<EnvelopesType> envelopes;             // absent: objects are their boxes
  std::unique_ptr<EnvelopeFilter<Scalar, Dim>> filter;  // with EnvelopeOptions::exact
  KeyTable keys;
  EventLists events;
  EventOrder order;
  StepStatus status = StepStatus::kDone;
};

template <class Scalar, int Dim>
KeyedEngine<Scalar, Dim>::KeyedEngine(Config config, const KeyType& type, EventLists events)
    : parts_(std::make_unique<Parts>(std::move(config), type, events)) {}

template <class Scalar, int Dim>
KeyedEngine<Scalar, Dim>::~KeyedEngine() = default;
template <class Scalar, int Dim>
KeyedEngine<Scalar, Dim>::KeyedEngine(KeyedEngine&& other) noexcept = default;
template <class Scalar, int Dim>
KeyedEngine<Scalar, Dim>& KeyedEngine<Scalar, Dim>::operator=(KeyedEngine&& other) noexcept = default;

template <class Scalar, int Dim>
inline auto KeyedEngine<Scalar, Dim>::parts(const char* call) const -> Parts& {
  if (parts_->stepping.load(std::memory_order_relaxed)) refuse_during_step(call);
  return *parts_;
}

// ---- queueing one call; many are in bulk.inl.hpp

template <class Scalar, int Dim>
Handle KeyedEngine<Scalar, Dim>::insert(const void* key, const BoxType& box) {
  return insert_one(key, box, Envelopes<Scalar, Dim>::kCommonMargin);
}

template <class Scalar, int Dim>
Handle KeyedEngine<Scalar, Dim>::insert(const void* key, const BoxType& box, double margin) {
  require_margin(key, "insert", margin);
  return insert_one(key, box, margin);
}

template <class Scalar, int Dim>
Handle KeyedEngine<Scalar, Dim>::insert_one(const void* key, const BoxType& box, double margin) {
  Parts& p = parts("insert");
  require_valid(box, key, "insert");
  Handle handle;
  bool added = false;
  try {
    added = p.keys.insert(key, [&] {
      if (!p.envelopes) return (handle = p.objects().insert(box)).index;
      const FloatingPointMode mode;
      const BoxType envelope = p.envelopes->envelope_of(box, margin);
      handle = p.objects().insert(envelope);
      p.envelopes->insert(handle, box, envelope, margin);
      return handle.index;
    });
  } catch (...) {  // there was no room, or the key could not be copied
    if (handle.index != kNoObject) {
      if (p.envelopes && p.envelopes->good(handle)) p.envelopes->cancel_insert(handle.index);
      p.objects().cancel_insert(handle.index);
    }
    throw;
  }
  if (!added)
    throw std::invalid_argument("sweepgrid: insert of " + p.keys.describe(key) + ": the key names a live object");
  return handle;
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::update(Handle object, const BoxType& box) {
  Parts& p = parts("update");
  if (!p.envelopes) {
    if (p.objects().update(object, box)) return;
  } else if (p.envelopes->good(object) && box.valid()) {
    const FloatingPointMode mode;
    return p.envelopes->update(object.index, box);
  }
  require_valid(box, p.keys.key(live(object, "update")), "update");
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::update(const void* key, const BoxType& box) {
  const ObjectId id = live(key, "update");
  update(parts_->objects().handle(id), box);
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::erase(Handle object) {
  const ObjectId id = live(object, "erase");
  Parts& p = *parts_;
  p.keys.erase(id);
  if (p.envelopes) p.envelopes->erase(id);
  p.objects().erase(id);
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::erase(const void* key) {
  erase(parts_->objects().handle(live(key, "erase")));
}

// ---- the step and what it leaves

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::step() {
  /// Lets calls be refused while the step runs.
  struct Stepping {
    explicit Stepping(std::atomic<bool>& on) : flag(on) {
      if (flag.exchange(true, std::memory_order_relaxed)) refuse_during_step("step");
    }
    ~Stepping() { flag.store(false, std::memory_order_relaxed); }
    Stepping(const Stepping&) = delete;
    Stepping& operator=(const Stepping&) = delete;
    std::atomic<bool>& flag;
  };
  Parts& p = *parts_;
  const Stepping stepping(p.stepping);
  const FloatingPointMode mode;
  const std::size_t freed_before = p.objects().free_ids().size();
  try {
    const bool done = p.envelopes ? step_with_envelopes() : step_core();
    p.status = done ? StepStatus::kDone : StepStatus::kOverBudget;
    if (!done) p.order.rest();
  } catch (...) {
    p.order.rest();
    release_keys(freed_before);
    throw;
  }
  release_keys(freed_before);
  if (!p.objects().anything_queued() && p.objects().trim()) trim_to_objects();
}

// Returns whether the step was done.
template <class Scalar, int Dim>
bool KeyedEngine<Scalar, Dim>::step_core() {
  Parts& p = *parts_;
  if (!p.objects().anything_queued()) p.order.rest();
  if (!p.core.step()) return false;
  p.core.count_events(p.begins(), p.ends());
  return true;
}

// The keys of objects whose ids the step has freed: its events hold copies.
template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::release_keys(std::size_t freed_before) {
  Parts& p = *parts_;
  if (p.keys.type().destroy == nullptr) return;
  for (const ObjectId object : p.objects().free_ids().subspan(freed_before)) p.keys.release(object);
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::trim_to_objects() {
  Parts& p = *parts_;
  const ObjectId bound = p.objects().bound();
  p.keys.trim(bound);
  p.order.trim(bound);
  if (p.envelopes) p.envelopes->trim(bound);
  if (p.filter) p.filter->trim(bound);
}

template <class Scalar, int Dim>
StepStatus KeyedEngine<Scalar, Dim>::status() const {
  return parts("status").status;
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::set_step_bytes(std::optional<std::uint64_t> bytes) {
  parts("set_step_bytes").core.set_step_bytes(bytes);
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::pairs(void* list) const {
  Parts& p = parts("pairs");
  const FloatingPointMode mode;
  const std::vector<PairKey> pairs = p.filter ? p.filter->pairs() : p.core.pairs();
  EventOrder order(p.keys, {[] { return std::size_t{1}; },
                            [&](EventOrder::List which, std::size_t /*i*/) {
                              return which == EventOrder::kBegins ? std::span(pairs) : std::span<const PairKey>();
                            },
                            [&] { return p.objects().bound(); }});
  order.run({nullptr, list});
}

// ---- what is asked for

template <class Scalar, int Dim>
std::size_t KeyedEngine<Scalar, Dim>::size() const {
  return parts("size").objects().size();
}

template <class Scalar, int Dim>
bool KeyedEngine<Scalar, Dim>::contains(const void* key) const {
  return parts("contains").keys.find(key) != kNoObject;
}

template <class Scalar, int Dim>
std::optional<Handle> KeyedEngine<Scalar, Dim>::find(const void* key) const {
  Parts& p = parts("find");
  const ObjectId id = p.keys.find(key);
  return id == kNoObject ? std::nullopt : std::optional(p.objects().handle(id));
}

template <class Scalar, int Dim>
auto KeyedEngine<Scalar, Dim>::box(Handle object) const -> BoxType {
  const ObjectId id = live(object, "box");
  return parts_->envelopes ? parts_->envelopes->box(id) : parts_->objects().record(id).box;
}

template <class Scalar, int Dim>
auto KeyedEngine<Scalar, Dim>::envelope(Handle object) const -> BoxType {
  return parts_->objects().record(live(object, "envelope")).box;
}

template <class Scalar, int Dim>
const void* KeyedEngine<Scalar, Dim>::key(Handle object) const {
  return parts_->keys.key(live(object, "key"));
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::validate() const {
  Parts& p = parts("validate");
  const FloatingPointMode mode;
  if (p.envelopes) {
    validate_envelopes();
  } else {
    p.core.validate();
  }
  validate_events();
}

template <class Scalar, int Dim>
Stats KeyedEngine<Scalar, Dim>::stats() const {
  Parts& p = parts("stats");
  Stats stats = p.core.stats();
  stats.bytes_objects += p.keys.bytes();
  stats.bytes_queues += sizeof(Parts) + p.order.bytes();
  if (p.envelopes) add_envelope_stats(stats);
  return stats;
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::record_tasks(bool on) {
  Parts& p = parts("record_tasks");
  p.core.graph().record(on);
  if (p.filter) p.filter->record(on);
}

template <class Scalar, int Dim>
const TaskTrace& KeyedEngine<Scalar, Dim>::tasks() const {
  Parts& p = parts("tasks");
  return p.filter ? p.filter->trace() : p.core.graph().trace();
}

template <class Scalar, int Dim>
std::vector<std::string> KeyedEngine<Scalar, Dim>::stage_names() const {
  Parts& p = parts("stage_names");
  std::vector<std::string> names;
  const auto add = [&](const StageGraph& graph) {
    for (StageGraph::StageId stage = 0; stage < graph.size(); ++stage) names.push_back(graph.name(stage));
  };
  add(p.core.graph());
  if (p.filter) add(p.filter->graph());
  return names;
}

// ---- errors

template <class Scalar, int Dim>
ObjectId KeyedEngine<Scalar, Dim>::live(Handle object, const char* call) const {
  if (!parts(call).objects().good(object)) {
    throw std::invalid_argument(std::string("sweepgrid: ") + call + " of " + describe(object) +
                                ": the handle is stale or of another engine");
  }
  return object.index;
}

template <class Scalar, int Dim>
ObjectId KeyedEngine<Scalar, Dim>::live(const void* key, const char* call) const {
  const Parts& p = parts(call);
  const ObjectId id = p.keys.find(key);
  if (id == kNoObject) {
    throw std::invalid_argument(std::string("sweepgrid: ") + call + " of " + p.keys.describe(key) +
                                ": no live object has the key");
  }
  return id;
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::require_valid(const BoxType& box, const void* key, const char* call) const {
  if (!box.valid()) {
    throw std::invalid_argument(std::string("sweepgrid: ") + call + " of " + parts_->keys.describe(key) + ": " +
                                describe_fault(box));
  }
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::require_same_size(std::size_t objects, std::size_t boxes, const char* call) {
  if (objects != boxes) {
    throw std::invalid_argument(std::string("sweepgrid: ") + call + " of " + std::to_string(objects) +
                                " objects with " + std::to_string(boxes) + " boxes");
  }
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::refuse_during_step(const char* call) {
  throw std::logic_error(std::string("sweepgrid: ") + call + " while step() runs");
}

}  // namespace sweepgrid

#include <sweepgrid/engine/bulk.inl.hpp>
#include <sweepgrid/engine/envelope_calls.inl.hpp>
#include <sweepgrid/engine/validate_events.inl.hpp>
