#pragma once

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <sweepgrid/engine/describe.hpp>
#include <sweepgrid/engine/engine.hpp>
#include <sweepgrid/sap/invariant.hpp>

namespace sweepgrid {

#define SWEEPGRID_ENGINE_TEMPLATE template <class Scalar, int Dim, class Key, class Hash, class Order>
#define SWEEPGRID_ENGINE Engine<Scalar, Dim, Key, Hash, Order>

SWEEPGRID_ENGINE_TEMPLATE
SWEEPGRID_ENGINE::Engine(Config config) : core_(config, sizeof(PairKey) + 2 * sizeof(Pair<Key>)) {
  make_envelopes(config.envelope);
  add_order_stages();
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::add_order_stages() {
  StageGraph& graph = filter_ ? filter_->graph() : core_.graph();
  const auto order = graph.add(
      "order", {filter_ ? filter_->last_stage() : core_.last_stage()},
      [this](std::vector<std::uint64_t>& costs) {
        const auto workers = static_cast<std::size_t>(core_.executor().concurrency());
        const std::size_t shards = std::min(event_lists(), workers);
        for (Sorter& sorter : sorters_) sorter.reset(shards);
        costs.assign(kLists * shards, 1);
      },
      [this](std::size_t task) { sort_shard(task % kLists, task / kLists); });
  graph.add(
      "merge", {order},
      [this](std::vector<std::uint64_t>& costs) {
        const auto workers = static_cast<std::size_t>(core_.executor().concurrency());
        for (std::size_t l = 0; l < kLists; ++l) ranges_[l] = sorters_[l].cut(2 * workers, list(l));
        costs.assign(ranges_[kEnds] + ranges_[kBegins], 1);
      },
      [this](std::size_t task) {
        const std::size_t l = task < ranges_[kEnds] ? kEnds : kBegins;
        sorters_[l].merge_range(l == kEnds ? task : task - ranges_[kEnds], list(l));
      });
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::sort_shard(std::size_t list, std::size_t shard) {
  auto& out = sorters_[list].shard(shard);
  const std::size_t shards = sorters_[list].shards();
  const auto add = [&](std::span<const PairKey> pairs) {
    for (const PairKey pair : pairs) out.push_back(keys_of(pair));
  };
  for (std::size_t i = shard * event_lists() / shards; i < (shard + 1) * event_lists() / shards; ++i) {
    if (filter_) {
      add(list == kEnds ? filter_->ends(i) : filter_->begins(i));
    } else {
      add(list == kEnds ? core_.ends(i) : core_.begins(i));
    }
  }
  sorters_[list].sort_shard(shard);
}

// ---- queueing one call; many are in bulk.inl.hpp

SWEEPGRID_ENGINE_TEMPLATE
Handle SWEEPGRID_ENGINE::insert(const Key& key, const BoxType& box) {
  require_valid(box, key, "insert");
  if (envelopes_) return insert_with_envelope(key, box, EnvelopesType::kCommonMargin);
  Handle handle;
  bool added = false;
  try {
    added = keys_.insert(key, [&] {
      handle = core_.objects().insert(box);
      return handle.index;
    });
  } catch (...) {  // the key could not be stored
    if (handle.index != kNoObject) core_.objects().cancel_insert(handle.index);
    throw;
  }
  if (!added) throw std::invalid_argument("sweepgrid: insert of " + describe(key) + ": the key names a live object");
  return handle;
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::update(Handle object, const BoxType& box) {
  if (envelopes_) return update_envelope(object, box);
  if (core_.objects().update(object, box)) return;
  require_valid(box, keys_.key(live(object, "update")), "update");
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::update(const Key& key, const BoxType& box) {
  const ObjectId id = live(key, "update");
  if (envelopes_) return update(core_.objects().handle(id), box);
  if (!core_.objects().update(core_.objects().handle(id), box)) require_valid(box, key, "update");
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::erase(Handle object) {
  const ObjectId id = live(object, "erase");
  keys_.erase(id);
  core_.objects().erase(id);
  if (envelopes_) envelopes_->erase(id);
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::erase(const Key& key) { erase(core_.objects().handle(live(key, "erase"))); }

// ---- the step and what it leaves

SWEEPGRID_ENGINE_TEMPLATE
const Events<Key>& SWEEPGRID_ENGINE::step() {
  try {
    const bool done = envelopes_ ? step_with_envelopes() : step_core();
    status_ = done ? StepStatus::kDone : StepStatus::kOverBudget;
    if (!done) forget_events();
  } catch (...) {
    forget_events();
    throw;
  }
  if (!core_.objects().anything_queued() && core_.objects().trim()) trim_to_objects();
  return events_;
}

// Returns whether the step was done.
SWEEPGRID_ENGINE_TEMPLATE
bool SWEEPGRID_ENGINE::step_core() {
  if (!core_.objects().anything_queued()) forget_events();
  if (!core_.step()) return false;
  if (!filter_) core_.count_events(events_.begins.size(), events_.ends.size());
  return true;
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::forget_events() {
  events_.ends.clear();
  events_.begins.clear();
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::trim_to_objects() {
  const ObjectId bound = core_.objects().bound();
  keys_.trim(bound);
  if (envelopes_) envelopes_->trim(bound);
  if (filter_) filter_->trim(bound);
}

SWEEPGRID_ENGINE_TEMPLATE
std::vector<Pair<Key>> SWEEPGRID_ENGINE::pairs() const {
  std::vector<Pair<Key>> pairs;
  for (const PairKey pair : filter_ ? filter_->pairs() : core_.pairs()) pairs.push_back(keys_of(pair));
  std::sort(pairs.begin(), pairs.end(), Sorter::kLess);
  return pairs;
}

SWEEPGRID_ENGINE_TEMPLATE
std::size_t SWEEPGRID_ENGINE::size() const { return core_.objects().size(); }

SWEEPGRID_ENGINE_TEMPLATE
bool SWEEPGRID_ENGINE::contains(const Key& key) const { return keys_.find(key) != kNoObject; }

SWEEPGRID_ENGINE_TEMPLATE
std::optional<Handle> SWEEPGRID_ENGINE::find(const Key& key) const {
  const ObjectId id = keys_.find(key);
  return id == kNoObject ? std::nullopt : std::optional(core_.objects().handle(id));
}

SWEEPGRID_ENGINE_TEMPLATE
auto SWEEPGRID_ENGINE::box(Handle object) const -> BoxType {
  const ObjectId id = live(object, "box");
  return envelopes_ ? envelopes_->box(id) : core_.objects().record(id).box;
}

SWEEPGRID_ENGINE_TEMPLATE
auto SWEEPGRID_ENGINE::envelope(Handle object) const -> BoxType {
  return core_.objects().record(live(object, "envelope")).box;
}

SWEEPGRID_ENGINE_TEMPLATE
const Key& SWEEPGRID_ENGINE::key(Handle object) const { return keys_.key(live(object, "key")); }

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::validate() const {
  if (envelopes_) {
    validate_envelopes();
  } else {
    core_.validate();
  }
  for (const auto* events : {&events_.ends, &events_.begins}) {
    const auto unordered = std::adjacent_find(events->begin(), events->end(),
                                              [](const auto& a, const auto& b) { return !Sorter::kLess(a, b); });
    require_invariant(unordered == events->end(), "E3", [&] {
      return "events are not sorted and unique at (" + describe(unordered->first) + ", " + describe(unordered->second) +
             ")";
    });
  }
  // E2 and the rest of E3: a pair that has just begun overlaps now; one that has just ended does not, unless new
  // objects took over its keys.
  const std::vector<Pair<Key>> now = pairs();
  const auto overlaps = [&](const Pair<Key>& pair) {
    return std::binary_search(now.begin(), now.end(), pair, Sorter::kLess);
  };
  for (const auto& pair : events_.begins) {
    require_invariant(overlaps(pair), "E2", [&] {
      return "a begin without an overlap: (" + describe(pair.first) + ", " + describe(pair.second) + ")";
    });
  }
  for (const auto& pair : events_.ends) {
    const bool begun = std::binary_search(events_.begins.begin(), events_.begins.end(), pair, Sorter::kLess);
    require_invariant(begun == overlaps(pair), "E3", [&] {
      return "an end of a pair that overlaps: (" + describe(pair.first) + ", " + describe(pair.second) + ")";
    });
  }
}

SWEEPGRID_ENGINE_TEMPLATE
Stats SWEEPGRID_ENGINE::stats() const {
  Stats stats = core_.stats();
  stats.bytes_objects += keys_.bytes();
  if (envelopes_) add_envelope_stats(stats);
  return stats;
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::record_tasks(bool on) {
  core_.graph().record(on);
  if (filter_) filter_->record(on);
}

SWEEPGRID_ENGINE_TEMPLATE
const TaskTrace& SWEEPGRID_ENGINE::tasks() const { return filter_ ? filter_->trace() : core_.graph().trace(); }

SWEEPGRID_ENGINE_TEMPLATE
std::vector<std::string> SWEEPGRID_ENGINE::stage_names() const {
  std::vector<std::string> names;
  const auto add = [&](const StageGraph& graph) {
    for (StageGraph::StageId stage = 0; stage < graph.size(); ++stage) names.push_back(graph.name(stage));
  };
  add(core_.graph());
  if (filter_) add(filter_->graph());
  return names;
}

// ---- errors

SWEEPGRID_ENGINE_TEMPLATE
ObjectId SWEEPGRID_ENGINE::live(Handle object, const char* call) const {
  if (!core_.objects().good(object)) {
    throw std::invalid_argument(std::string("sweepgrid: ") + call + " of " + describe(object) +
                                ": the handle is stale or of another engine");
  }
  return object.index;
}

SWEEPGRID_ENGINE_TEMPLATE
ObjectId SWEEPGRID_ENGINE::live(const Key& key, const char* call) const {
  const ObjectId id = keys_.find(key);
  if (id == kNoObject) {
    throw std::invalid_argument(std::string("sweepgrid: ") + call + " of " + describe(key) +
                                ": no live object has the key");
  }
  return id;
}

SWEEPGRID_ENGINE_TEMPLATE
template <class Name>
void SWEEPGRID_ENGINE::require_valid(const BoxType& box, const Name& object, const char* call) {
  if (!box.valid()) {
    throw std::invalid_argument(std::string("sweepgrid: ") + call + " of " + describe(object) + ": " +
                                describe_fault(box));
  }
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::require_same_size(std::size_t objects, std::size_t boxes, const char* call) {
  if (objects != boxes) {
    throw std::invalid_argument(std::string("sweepgrid: ") + call + " of " + std::to_string(objects) +
                                " objects with " + std::to_string(boxes) + " boxes");
  }
}

#undef SWEEPGRID_ENGINE_TEMPLATE
#undef SWEEPGRID_ENGINE

}  // namespace sweepgrid

#include <sweepgrid/engine/bulk.inl.hpp>
#include <sweepgrid/engine/envelope_calls.inl.hpp>
