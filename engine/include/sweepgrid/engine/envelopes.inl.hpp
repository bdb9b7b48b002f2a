#pragma once

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include <sweepgrid/engine/envelopes.hpp>
#include <sweepgrid/sap/invariant.hpp>

namespace sweepgrid {

template <class Scalar, int Dim>
Envelopes<Scalar, Dim>::Envelopes(const EnvelopeOptions& options)
    : options_(options),
      tracks_(options.swept || options.stride > 1 || options.exact),
      fade_(ObjectSpeed::fade_of(std::max(options.stride, 1))),
      age_(options.stride - 1) {
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
  report_.margin = rounded(options.margin);
}

// ---- queueing

template <class Scalar, int Dim>
auto Envelopes<Scalar, Dim>::envelope_of(const BoxType& box, double margin) const -> BoxType {
  return box.valid() ? grown(box, rounded(margin < 0 ? options_.margin : margin)) : box;
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::make_room(std::uint64_t bound) {
  if (bound <= records_.size()) return;
  const std::lock_guard growth(growth_);
  const std::uint64_t old_bound = records_.size();
  if (bound <= old_bound) return;
  const std::uint64_t ends = (bound + kGranule - 1) / kGranule * kGranule;  // so that the lock is not taken for each
  marks_.grow(ends / kGranule);
  states_.grow(ends);
  for (std::uint64_t object = old_bound; object < ends; ++object) states_[static_cast<ObjectId>(object)] = 0;
  if (options_.exact || options_.swept) others_.grow(ends);
  if (options_.margin_steps > 0) speeds_.grow(ends);
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
  if (options_.margin_steps > 0) speeds_[object.index].appear(now());
  states_[object.index] = kLive;
  if (!tracks_) return;
  states_[object.index] = static_cast<std::uint16_t>(kLive | kFresh | (options_.exact ? kBorn : 0));
  mark(object.index);
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::mark(ObjectId object) {
  marks_.mark(object / kGranule);
  if (!marked_.load(std::memory_order_relaxed)) marked_.store(true, std::memory_order_relaxed);
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::update(ObjectId object, const BoxType& box) {
  note_displacement(object, box);
  Record& record = records_[object];
  std::uint16_t& state = states_[object];
  if (!tracks_) {
    record.box = box;
    if (fits(object)) return;
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
  note_displacement(object, box);
  Record& record = records_[object];
  std::uint16_t& state = states_[object];
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
  recycle();
  early_ = false;
  query_ = age_ + 1 >= options_.stride;
  if (!marked_.load(std::memory_order_relaxed)) return query_;
  collect_granules();
  if (query_) {
    scan(executor, [&](ObjectId object, Block& out) { renew(object, objects, out); });
  } else {
    scan(executor, [&](ObjectId object, Block& out) { check(object, objects, out); });
  }
  for (const Block& block : blocks()) {
    for (const ObjectId object : block.outside) outside_.push_back({object, records_[object].generation});
    if (!query_ && !block.seen.empty()) early_ = true;
  }
  return query_ = query_ || early_;
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::end_step(Executor& executor) {
  ++report_.steps;
  report_.violations += outside_.size();
  std::swap(report_.outside, outside_);
  queried_ = query_;
  age_ = query_ && !early_ ? 0 : age_ + 1;
  if (!query_) return;
  ++report_.queries;
  report_.early += early_ ? 1 : 0;
  if (granules_.empty()) return;
  double margin = -1;
  for (const Block& block : blocks()) margin = std::max(margin, block.margin);
  if (margin >= 0) report_.margin = margin;
  if (!early_) {  // else others are still to be looked at
    for (const std::uint32_t granule : granules_) marks_.unmark(granule);
    marked_.store(false, std::memory_order_relaxed);
  }
  for_blocks(executor, [this](std::size_t block) {
    for (const auto& [object, state] : blocks_[block].seen) {
      states_[object] = state;
      if ((state & kStretched) != 0) mark(object);
    }
  });
}

// What begin_step() queued with the object table is taken out of it again, whether or not the core has been given it.
template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::cancel_step(Objects& objects) noexcept {
  const auto put_back = [&](ObjectId object, const BoxType& envelope) {
    records_[object].envelope = envelope;
    objects.record(object).box = envelope;
  };
  for (const Block& block : blocks()) {
    for (const auto& [object, envelope] : block.first) put_back(object, envelope);
  }
  for (const std::uint32_t granule : granules_) {
    for (ObjectId object = granule * kGranule; object < (granule + 1) * kGranule; ++object) {
      if ((states_[object] & kLive) == 0) continue;
      std::uint8_t& queued = objects.state(object);
      if ((queued & (Objects::kInserted | Objects::kUpdated)) != Objects::kUpdated) continue;
      put_back(object, objects.record(object).before);
      queued &= static_cast<std::uint8_t>(~Objects::kUpdated);
    }
  }
  for (Block& block : blocks()) block.first.clear();
}

// Lists keep only what steps of late needed.
template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::recycle() {
  granules_water_.recycle(granules_);
  outside_water_.recycle(outside_);
  for (Block& block : blocks_) {
    block.water[0].recycle(block.outside);
    block.water[1].recycle(block.seen);
    block.water[2].recycle(block.first);
    block.margin = -1;
  }
  blocks_used_ = 0;
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::collect_granules() {
  marks_.for_each(static_cast<std::uint32_t>(bound() / kGranule),
                  [&](std::uint32_t granule) { granules_.push_back(granule); });
}

// Calls `visit(object, block)` for the objects in marked granules that are to be looked at.
template <class Scalar, int Dim>
template <class Visit>
void Envelopes<Scalar, Dim>::scan(Executor& executor, Visit&& visit) {
  constexpr std::size_t kSmallest = 8;  // granules that are worth a task
  const auto workers = static_cast<std::size_t>(executor.concurrency());
  const std::size_t wanted = workers == 1 ? 1 : std::clamp<std::size_t>(granules_.size() / kSmallest, 1, 4 * workers);
  if (blocks_.size() < wanted) blocks_.resize(wanted);
  blocks_used_ = wanted;
  for_blocks(executor, [&](std::size_t index) {
    Block& block = blocks_[index];
    for (std::size_t i = index * granules_.size() / wanted; i < (index + 1) * granules_.size() / wanted; ++i) {
      const ObjectId first = granules_[i] * kGranule;
      const std::uint16_t* const states = &states_[first];  // a granule is contiguous
      for (ObjectId own = 0; own < kGranule; ++own) {
        if ((states[own] & (kFresh | kMoved | kStretched)) != 0) visit(first + own, block);
      }
    }
  });
}

template <class Scalar, int Dim>
template <class Body>
void Envelopes<Scalar, Dim>::for_blocks(Executor& executor, Body&& body) {
  if (blocks_used_ == 1) return body(0);
  executor.for_each(blocks_used_, std::ref(body));  // by reference, lest it be allocated
}

// A step that is not to be a query: who is outside of what the latest one covered is named, or gets a new envelope.
// Nobody else does, so that an early query costs those that made it necessary, and nobody's stride begins anew.
template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::check(ObjectId object, Objects& objects, Block& out) {
  const std::uint16_t state = states_[object];
  if ((state & kLive) == 0) return;
  const Record& record = records_[object];
  if (options_.swept && (state & kMoved) != 0) others_[object] = hull(others_[object], record.box);
  if ((state & kFresh) == 0 && holds(record.envelope, record.box)) return;
  if (options_.on_violation == OnViolation::kQuery) {
    renew(object, objects, out);
  } else {
    out.outside.push_back(object);
  }
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::renew(ObjectId object, Objects& objects, Block& out) {
  const std::uint16_t state = states_[object];
  if ((state & kLive) == 0) return;
  Record& record = records_[object];
  const double margin = margin_of(object);
  const bool ahead = (state & kAhead) != 0;
  // An object whose prediction held and that has a new one needs no way from its previous box.
  if (ahead && (state & kPromised) != 0 && !holds(record.envelope, record.box)) out.outside.push_back(object);
  const bool appears = (state & kFresh) != 0 && options_.stride == 1 && !ahead;  // has no way behind it
  const bool way = options_.swept && (state & kMoved) != 0 && !appears;
  const BoxType needed = way ? hull(record.box, others_[object]) : record.box;
  const bool lasts = options_.stride == 1 || holds(record.envelope, grown(record.box, margin / 2));
  int after = state & ~(kFresh | kMoved | kStretched | kAhead | kPromised);
  if (ahead) after |= kPromised;
  const bool made = !lasts || !holds(record.envelope, needed) || loose(record.envelope, needed, margin);
  const BoxType envelope = made ? grown(needed, margin) : record.envelope;
  if (way && loose(envelope, record.box, margin)) after |= kStretched;
  out.seen.push_back({object, static_cast<std::uint16_t>(after)});
  if (!made) return;
  if ((objects.state(object) & Objects::kInserted) != 0) out.first.emplace_back(object, record.envelope);
  if (record.margin < 0) out.margin = std::max(out.margin, margin);
  record.envelope = envelope;
  objects.update({object, record.generation}, envelope);
}

template <class Scalar, int Dim>
void Envelopes<Scalar, Dim>::settle(std::uint32_t granule) noexcept {
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
  speeds_.shrink(bound);
  marks_.shrink(bound / kGranule);
}

template <class Scalar, int Dim>
std::size_t Envelopes<Scalar, Dim>::bytes() const {
  const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
  std::size_t bytes =
      sizeof(*this) + records_.bytes() + states_.bytes() + others_.bytes() + speeds_.bytes() + marks_.bytes();
  bytes += of(granules_) + of(outside_) + of(report_.outside) + of(blocks_);
  for (const Block& block : blocks_) bytes += of(block.outside) + of(block.seen) + of(block.first);
  return bytes;
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
    require_invariant((state & (kFresh | kMoved | kStretched)) == 0 || marks_.marked(object / kGranule), "V1",
                      [&] { return name() + " is to be looked at, but not marked"; });
  }
}

}  // namespace sweepgrid
