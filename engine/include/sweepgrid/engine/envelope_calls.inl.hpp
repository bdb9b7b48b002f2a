#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <sweepgrid/engine/engine.hpp>

// What the engine's calls do beside, or instead, with Config::envelope.
namespace sweepgrid {

#define SWEEPGRID_ENGINE_TEMPLATE template <class Scalar, int Dim, class Key, class Hash, class Order>
#define SWEEPGRID_ENGINE Engine<Scalar, Dim, Key, Hash, Order>

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::make_envelopes(const std::optional<EnvelopeOptions>& options) {
  if (!options) return;
  envelopes_ = std::make_unique<EnvelopesType>(*options);
  if (options->exact) filter_ = std::make_unique<FilterType>(core_, *envelopes_);
}

// ---- queueing

SWEEPGRID_ENGINE_TEMPLATE
Handle SWEEPGRID_ENGINE::insert(const Key& key, const BoxType& box, double margin) {
  require_valid(box, key, "insert");
  require_margin(key, "insert", margin);
  return insert_with_envelope(key, box, margin);
}

SWEEPGRID_ENGINE_TEMPLATE
Handle SWEEPGRID_ENGINE::insert_with_envelope(const Key& key, const BoxType& box, double margin) {
  const BoxType envelope = envelopes_->envelope_of(box, margin);
  Handle handle;
  bool added = false;
  try {
    added = keys_.insert(key, [&] {
      handle = core_.objects().insert(envelope);
      envelopes_->insert(handle, box, envelope, margin);
      return handle.index;
    });
  } catch (...) {  // there was no room
    if (handle.index != kNoObject) {
      if (envelopes_->good(handle)) envelopes_->cancel_insert(handle.index);
      core_.objects().cancel_insert(handle.index);
    }
    throw;
  }
  if (!added) throw std::invalid_argument("sweepgrid: insert of " + describe(key) + ": the key names a live object");
  return handle;
}

// Also makes room, so that nothing can fail once the objects are in.
SWEEPGRID_ENGINE_TEMPLATE
auto SWEEPGRID_ENGINE::envelopes_of(std::span<const BoxType> boxes) -> std::vector<BoxType> {
  envelopes_->make_room(core_.objects().bound());
  std::vector<BoxType> envelopes(boxes.size());
  std::vector<Share> shares = shares_of(boxes.size());
  for_shares(shares, [&](const Share& share) {
    for (std::size_t i = 0; i < share.items.size(); ++i) {
      envelopes[share.items[i]] = envelopes_->envelope_of(boxes[share.items[i]]);
    }
  });
  return envelopes;
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::store_envelopes(std::span<const Handle> handles, std::span<const BoxType> boxes,
                                       std::span<const BoxType> envelopes) {
  std::vector<Share> shares = shares_of(boxes.size());
  for_shares(shares, [&](const Share& share) {
    for (std::size_t i = 0; i < share.items.size(); ++i) {
      const std::size_t item = share.items[i];
      envelopes_->insert(handles[item], boxes[item], envelopes[item]);
    }
  });
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::update_envelope(Handle object, const BoxType& box) {
  if (!envelopes_->good(object) || !box.valid()) require_valid(box, keys_.key(live(object, "update")), "update");
  envelopes_->update(object.index, box);
}

// First all items are looked at, then all are applied.
SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::update_envelopes(std::span<const Handle> objects, std::span<const BoxType> boxes) {
  constexpr std::size_t kAhead = 12;
  const ObjectPartition partition = partition_of(objects);
  std::vector<Share> shares = shares_of(partition);
  for_shares(shares, [&](Share& share) {
    std::size_t checked = 0;
    for (; checked < share.items.size(); ++checked) {
      if (checked + kAhead < share.items.size()) envelopes_->prefetch(objects[share.items[checked + kAhead]]);
      const std::size_t item = share.items[checked];
      if (!envelopes_->good(objects[item]) || !boxes[item].valid()) break;
    }
    share.checked = checked;
  });
  if (const auto bad = first_bad(shares)) {
    require_valid(boxes[*bad], keys_.key(live(objects[*bad], "update")), "update");
  }
  for_shares(shares, [&](const Share& share) {
    double farthest = 0;
    for (std::size_t i = 0; i < share.items.size(); ++i) {
      if (i + kAhead < share.items.size()) envelopes_->prefetch(objects[share.items[i + kAhead]]);
      const std::size_t item = share.items[i];
      envelopes_->replace(objects[item].index, boxes[item], farthest);
    }
    envelopes_->measure(farthest);
  });
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::update(Handle object, const BoxType& box, const Displacement& ahead) {
  const Key& key = keys_.key(live(object, "update"));
  require_valid(box, key, "update");
  const std::string name = "sweepgrid: update of " + describe(key) + ": ";
  if (!envelopes_ || !envelopes_->options().swept) {
    throw std::invalid_argument(name + "a displacement needs Config::envelope with EnvelopeOptions::swept");
  }
  if (!std::all_of(ahead.begin(), ahead.end(), [](double by) { return std::isfinite(by); })) {
    throw std::invalid_argument(name + "its displacement is not finite");
  }
  envelopes_->update(object.index, box, ahead);
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::set_margin(Handle object, double margin) {
  const ObjectId id = live(object, "set_margin");
  require_margin(keys_.key(id), "set_margin", margin);
  envelopes_->set_margin(id, margin);
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::require_margin(const Key& key, const char* call, double margin) const {
  const std::string name = std::string("sweepgrid: ") + call + " of " + describe(key) + ": ";
  if (!envelopes_) throw std::invalid_argument(name + "a margin needs Config::envelope");
  if (!(margin >= 0 && std::isfinite(margin))) {
    throw std::invalid_argument(name + "its margin is " + std::to_string(margin) +
                                ", but must be finite and not negative");
  }
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::erase_envelopes(const Share& share, std::span<const Handle> objects) {
  for (std::size_t i = 0; i < share.items.size(); ++i) envelopes_->erase(objects[share.items[i]].index);
}

// ---- the step

SWEEPGRID_ENGINE_TEMPLATE
bool SWEEPGRID_ENGINE::step_with_envelopes() {
  bool query = false;
  bool done = true;
  try {
    query = envelopes_->begin_step(core_.objects(), core_.executor());
    if (query) done = step_core();
  } catch (...) {
    envelopes_->cancel_step(core_.objects());
    throw;
  }
  if (!done) {
    envelopes_->cancel_step(core_.objects());
    return false;
  }
  if (query) envelopes_->end_query(core_.executor());
  if (!filter_) {
    if (!query) forget_events();
    return true;
  }
  if (!filter_->step(query)) forget_events();
  filter_->count_events(events_.begins.size(), events_.ends.size());
  return true;
}

// ---- what is asked for

SWEEPGRID_ENGINE_TEMPLATE
EnvelopeReport SWEEPGRID_ENGINE::envelope_report() const {
  EnvelopeReport report;
  if (!envelopes_) return report;
  report = envelopes_->report();
  report.candidates = core_.pair_count();
  return report;
}

// A step that is no query leaves the core as it was, and its events are those of the filter.
SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::add_envelope_stats(Stats& stats) const {
  stats.steps = envelopes_->steps();
  stats.bytes_objects += envelopes_->bytes();
  if (!envelopes_->queried()) {
    stats.step = StepCounters{};
    for (StageTime& stage : stats.stages) stage.seconds = 0;
  }
  if (filter_) filter_->add_stats(stats);
}

SWEEPGRID_ENGINE_TEMPLATE
void SWEEPGRID_ENGINE::validate_envelopes() const {
  envelopes_->validate(core_.objects());
  if (core_.objects().anything_queued()) return;  // for the next query
  core_.validate();
  if (filter_) filter_->validate();
}

#undef SWEEPGRID_ENGINE_TEMPLATE
#undef SWEEPGRID_ENGINE

}  // namespace sweepgrid
