#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include <sweepgrid/engine/envelopes.hpp>
#include <sweepgrid/sap/invariant.hpp>

namespace sweepgrid {

template <class Scalar, int Dim>
Envelopes<Scalar, Dim>::Envelopes(const EnvelopeOptions& options)
    : options_(options), tracks_(options.swept || options.stride > 1 || options.exact), age_(options.stride - 1) {
  const auto refuse = [](const std::string& what) {
    throw std::invalid_argument("sweepgrid: EnvelopeOptions::" + what);
  };
  const auto require_amount = [&](const char* name, double value) {
    if (value >= 0 && std::isfinite(value)) return;
    refuse(std::string(name) + " is " + std::to_string(value) + ", but must be finite and not negative");
  };
  require_amount("margin", options.margin);
  require_amount("margin_steps", options.margin_steps);
  if (options.stride < 1) refuse("stride is " + std::to_string(options.stride) + ", but must be at least 1");
  if (options.exact && options.swept) refuse("exact is for boxes at the steps, swept for the way between: not both");
  margin_ = options.margin;
}

// ---- queueing

template <class Scalar, int Dim>
auto Envelopes<Scalar, Dim>::envelope_of(const BoxType& box, double margin) const -> BoxType {
  return box.valid() ? grown(box, margin_of(margin)) : box;
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::make_room(std::uint64_t bound) {
  if (bound <= records_.size()) return;
  const std::lock_guard growth(growth_);
  const std::uint64_t old_bound = records_.size();
  if (bound <= old_bound) return;
  const std::uint64_t ends = (bound + kGranule - 1) / kGranule * kGranule;  // so that the lock is not taken for each
  marks_.grow(ends / kGranule);
  for (std::uint64_t granule = old_bound / kGranule; granule < ends / kGranule; ++granule) {
    marks_[static_cast<std::uint32_t>(granule)] = 0;
  }
  states_.grow(ends);
  for (std::uint64_t object = old_bound; object < ends; ++object) states_[static_cast<ObjectId>(object)] = 0;
  if (options_.exact || options_.swept) others_.grow(ends);
  records_.grow(ends);
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::insert(Handle object, const BoxType& box, const BoxType& envelope, double margin) {
  make_room(std::uint64_t{object.index} + 1);
  Record& record = records_[object.index];
  record.box = box;
  record.envelope = envelope;
  record.generation = object.generation;
  record.margin = static_cast<float>(margin);
  states_[object.index] = kLive;
  if (!tracks_) return;
  states_[object.index] = static_cast<std::uint16_t>(kLive | kFresh | (options_.exact ? kBorn : 0));
  mark(object.index);
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::mark(ObjectId object) {
  const std::atomic_ref<std::uint8_t> granule(marks_[object / kGranule]);
  if (granule.load(std::memory_order_relaxed) == 0) granule.store(1, std::memory_order_relaxed);
  if (!marked_.load(std::memory_order_relaxed)) marked_.store(true, std::memory_order_relaxed);
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::measure(double farthest) {
  double known = farthest_.load(std::memory_order_relaxed);
  while (farthest > known && !farthest_.compare_exchange_weak(known, farthest, std::memory_order_relaxed)) {
  }
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::replace(ObjectId object, const BoxType& box, double& farthest) {
  Record& record = records_[object];
  std::uint16_t& state = states_[object];
  if (options_.margin_steps > 0) farthest = std::max(farthest, displacement(record.box, box));
  if (!tracks_) {
    record.box = box;
    if (fits(record)) return;
    state |= kMoved;
    return mark(object);
  }
  const bool rests = Objects::same_bits(record.box, box);
  if (rests && (state & kAhead) == 0) return;  // a resting object that its client reports anyway costs nothing more
  if (options_.exact && (state & kChanged) == 0) others_[object] = record.box;
  if (options_.swept) {
    // Where it was is not known any more, but that its envelope held it is.
    if ((state & kAhead) != 0 && options_.stride == 1) others_[object] = record.envelope;
    if ((state & kMoved) == 0) others_[object] = record.box;
  }
  record.box = box;
  state = static_cast<std::uint16_t>((state & ~kAhead) | kMoved | (options_.exact ? kChanged : 0));
  mark(object);
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::update(ObjectId object, const BoxType& box, const Displacement& ahead) {
  Record& record = records_[object];
  std::uint16_t& state = states_[object];
  if (options_.margin_steps > 0) measure(displacement(record.box, box));
  const BoxType way = swept(box, ahead);
  if (options_.stride == 1) {
    others_[object] = way;
  } else {  // beside the way since the latest query
    others_[object] = hull((state & kMoved) != 0 ? others_[object] : record.box, way);
  }
  record.box = box;
  state |= kMoved | kAhead;
  mark(object);
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::set_margin(ObjectId object, double margin) {
  records_[object].margin = static_cast<float>(margin);
  states_[object] |= kStretched;
  mark(object);
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::erase(ObjectId object) {
  std::uint16_t& state = states_[object];
  if (!options_.exact) {
    state = 0;
    return;
  }
  state = static_cast<std::uint16_t>((state & ~kLive) | kErased);
  mark(object);
}

// ---- the step

template <class Scalar, int Dim>
bool Envelopes<Scalar, Dim>::begin_step(Objects& objects, Executor& executor) {
  ++report_.steps;
  ++age_;
  report_.outside.clear();
  granules_.clear();
  early_ = false;
  bool query = age_ >= options_.stride;
  if (marked_.load(std::memory_order_relaxed)) {
    collect_granules();
    if (!query) {
      find_outside(executor);
      if (!report_.outside.empty() && options_.on_violation == OnViolation::kQuery) {
        query = early_ = true;
        report_.outside.clear();
      }
    }
    if (query) renew(executor, objects);
  }
  if (!query) report_.violations += report_.outside.size();
  return query;
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::end_query(Executor& executor) {
  age_ = 0;
  ++report_.queries;
  report_.early += early_ ? 1 : 0;
  report_.violations += report_.outside.size();
  if (granules_.empty()) return;
  largest_ = largest_now();
  farthest_.store(0, std::memory_order_relaxed);
  for (const std::uint32_t granule : granules_) marks_[granule] = 0;
  marked_.store(false, std::memory_order_relaxed);
  const auto settle_block = [this](std::size_t block) {
    blocks_[block].first.clear();
    for (const auto& [object, state] : blocks_[block].seen) {
      states_[object] = state;
      if ((state & kStretched) != 0) mark(object);
    }
  };
  if (blocks_.size() == 1) {
    settle_block(0);
  } else {
    executor.for_each(blocks_.size(), settle_block);
  }
}

// What was queued with the object table stays so, but with the envelopes of the latest step.
template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::cancel_step(Objects& objects) {
  --report_.steps;
  --age_;
  report_.outside.clear();
  margin_ = common_margin(largest_);
  if (granules_.empty()) return;
  const auto put_back = [&](ObjectId object, const BoxType& envelope) {
    records_[object].envelope = envelope;
    objects.update({object, records_[object].generation}, envelope);
  };
  for (Block& block : blocks_) {
    for (const auto& [object, envelope] : block.first) put_back(object, envelope);
    block.first.clear();
  }
  for (const std::uint32_t granule : granules_) {
    for (ObjectId object = granule * kGranule; object < (granule + 1) * kGranule; ++object) {
      if ((states_[object] & kLive) == 0) continue;
      if ((objects.state(object) & (Objects::kInserted | Objects::kUpdated)) != Objects::kUpdated) continue;
      put_back(object, objects.record(object).before);
    }
  }
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::collect_granules() {
  for (std::uint32_t granule = 0; granule < bound() / kGranule; ++granule) {
    if (marks_[granule] != 0) granules_.push_back(granule);
  }
}

// Calls `visit(object, block)` for the objects in marked granules that are to be looked at.
template <class Scalar, int Dim>
template <class Visit>
void Envelopes<Scalar, Dim>::scan(Executor& executor, Visit&& visit) {
  constexpr std::size_t kSmallest = 8;  // granules that are worth a task
  const auto workers = static_cast<std::size_t>(executor.concurrency());
  const std::size_t wanted = workers == 1 ? 1 : std::clamp<std::size_t>(granules_.size() / kSmallest, 1, 4 * workers);
  blocks_.resize(wanted);
  const auto scan_block = [&](std::size_t index) {
    Block& block = blocks_[index];
    block.outside.clear();
    block.seen.clear();
    block.first.clear();
    for (std::size_t i = index * granules_.size() / wanted; i < (index + 1) * granules_.size() / wanted; ++i) {
      const ObjectId first = granules_[i] * kGranule;
      const std::uint16_t* const states = &states_[first];  // a granule is contiguous
      for (ObjectId own = 0; own < kGranule; ++own) {
        if ((states[own] & (kFresh | kMoved | kStretched)) != 0) visit(first + own, block);
      }
    }
  };
  if (wanted == 1) {
    scan_block(0);
  } else {
    executor.for_each(wanted, scan_block);
  }
  for (const Block& block : blocks_) {
    for (const ObjectId object : block.outside) report_.outside.push_back({object, records_[object].generation});
  }
}

// A step that is no query: who is outside of what the latest one covered.
template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::find_outside(Executor& executor) {
  scan(executor, [this](ObjectId object, Block& out) {
    const std::uint16_t state = states_[object];
    if ((state & kLive) == 0) return;
    const Record& record = records_[object];
    if (options_.swept && (state & kMoved) != 0) others_[object] = hull(others_[object], record.box);
    if ((state & kFresh) != 0 || !holds(record.envelope, record.box)) out.outside.push_back(object);
  });
}

// A query: queues the envelopes that it needs.
template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::renew(Executor& executor, Objects& objects) {
  margin_ = common_margin(largest_now());
  scan(executor, [&](ObjectId object, Block& out) { renew(object, objects, out); });
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::renew(ObjectId object, Objects& objects, Block& out) {
  const std::uint16_t state = states_[object];
  if ((state & kLive) == 0) return;
  Record& record = records_[object];
  const double margin = margin_of(record.margin);
  const bool ahead = (state & kAhead) != 0;
  // Whoever goes where it was said to go again needs no way that leads there.
  if (ahead && (state & kPromised) != 0 && !holds(record.envelope, record.box)) out.outside.push_back(object);
  const bool appears = (state & kFresh) != 0 && options_.stride == 1 && !ahead;  // has no way behind it
  const bool way = options_.swept && (state & kMoved) != 0 && !appears;
  const BoxType needed = way ? hull(record.box, others_[object]) : record.box;
  const bool lasts = options_.stride == 1 || holds(record.envelope, grown(record.box, margin / 2));
  if (!lasts || !holds(record.envelope, needed) || loose(record, needed)) {
    if ((objects.state(object) & Objects::kInserted) != 0) out.first.emplace_back(object, record.envelope);
    record.envelope = grown(needed, margin);
    objects.update({object, record.generation}, record.envelope);
  }
  int after = state & ~(kFresh | kMoved | kStretched | kAhead | kPromised);
  if (ahead) after |= kPromised;
  if (way && loose(record, record.box)) after |= kStretched;
  out.seen.push_back({object, static_cast<std::uint16_t>(after)});
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::settle(std::uint32_t granule) {
  std::uint16_t* const states = &states_[granule * kGranule];
  for (ObjectId own = 0; own < kGranule; ++own) {
    const bool erased = (states[own] & kErased) != 0;
    states[own] = erased ? 0 : static_cast<std::uint16_t>(states[own] & ~(kChanged | kBorn));
  }
}

// ---- what is asked for

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::trim(std::uint64_t bound) {
  bound = (bound + kGranule - 1) / kGranule * kGranule;
  records_.shrink(bound);
  states_.shrink(bound);
  others_.shrink(bound);
  marks_.shrink(bound / kGranule);
}

template <class Scalar, int Dim>
EnvelopeReport Envelopes<Scalar, Dim>::report() const {
  EnvelopeReport report = report_;
  report.margin = margin_;
  return report;
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::validate(const Objects& objects) const {
  for (ObjectId object = 0; object < bound(); ++object) {
    const std::uint16_t state = states_[object];
    if ((state & kLive) == 0) continue;
    const Record& record = records_[object];
    const auto name = [&] { return "object " + std::to_string(object); };
    require_invariant(objects.good({object, record.generation}), "V1", [&] { return name() + " is not live"; });
    const BoxType& known = objects.record(object).box;
    require_invariant(holds(known, record.envelope) && holds(record.envelope, known), "V1",
                      [&] { return name() + " has another envelope in the table of objects"; });
    const bool outside = std::any_of(report_.outside.begin(), report_.outside.end(),
                                     [&](Handle handle) { return handle.index == object; });
    require_invariant(outside || holds(record.envelope, record.box), "V1",
                      [&] { return name() + " has left its envelope, and nobody says so"; });
    require_invariant((state & (kFresh | kMoved | kStretched)) == 0 || marks_[object / kGranule] != 0, "V1",
                      [&] { return name() + " is to be looked at, but not marked"; });
  }
}

}  // namespace sweepgrid
