#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <sweepgrid/engine/keyed_engine.hpp>

// What the engine's calls do beside, or instead, with Config::envelope.
namespace sweepgrid {

// ---- queueing

template <class Scalar, int Dim>
auto KeyedEngine<Scalar, Dim>::envelopes_of(std::span<const BoxType> boxes) const -> std::vector<BoxType> {
  const Parts& p = *parts_;
  std::vector<BoxType> envelopes(boxes.size());
  auto shares = bulk::shares_of<typename Parts::Share>(boxes.size());
  p.for_shares(shares, [&](const auto& share) {
    for (std::size_t i = 0; i < share.items.size(); ++i) {
      envelopes[share.items[i]] = p.envelopes->envelope_of(boxes[share.items[i]]);
    }
  });
  return envelopes;
}

// First all items are looked at, then all are applied.
template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::update_envelopes(std::span<const Handle> objects, std::span<const BoxType> boxes) {
  constexpr std::size_t kAhead = 12;
  Parts& p = *parts_;
  auto& table = *p.envelopes;
  const ObjectPartition partition = p.partition_of(objects);
  auto shares = bulk::shares_of<typename Parts::Share>(partition);
  p.for_shares(shares, [&](auto& share) {
    std::size_t checked = 0;
    for (; checked < share.items.size(); ++checked) {
      if (checked + kAhead < share.items.size()) table.prefetch(objects[share.items[checked + kAhead]]);
      const std::size_t item = share.items[checked];
      if (!table.good(objects[item]) || !boxes[item].valid()) break;
    }
    share.checked = checked;
  });
  if (const auto bad = bulk::first_bad(shares)) {
    require_valid(boxes[*bad], p.keys.key(live(objects[*bad], "update")), "update");
  }
  p.for_shares(shares, [&](const auto& share) {
    for (std::size_t i = 0; i < share.items.size(); ++i) {
      if (i + kAhead < share.items.size()) table.prefetch(objects[share.items[i + kAhead]]);
      const std::size_t item = share.items[i];
      table.update(objects[item].index, boxes[item]);
    }
  });
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::update(Handle object, const BoxType& box, const Displacement& ahead) {
  const void* const key = parts("update").keys.key(live(object, "update"));
  Parts& p = *parts_;
  require_valid(box, key, "update");
  const std::string name = "sweepgrid: update of " + p.keys.describe(key) + ": ";
  if (!p.envelopes || !p.envelopes->options().swept) {
    throw std::invalid_argument(name + "a displacement needs Config::envelope with EnvelopeOptions::swept");
  }
  if (!std::all_of(ahead.begin(), ahead.end(), [](double by) { return std::isfinite(by); })) {
    throw std::invalid_argument(name + "its displacement is not finite");
  }
  const FloatingPointMode mode;
  p.envelopes->update(object.index, box, ahead);
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::set_margin(Handle object, double margin) {
  const ObjectId id = live(object, "set_margin");
  require_margin(parts_->keys.key(id), "set_margin", margin);
  parts_->envelopes->set_margin(id, margin);
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::require_margin(const void* key, const char* call, double margin) const {
  const Parts& p = parts(call);
  const std::string name = std::string("sweepgrid: ") + call + " of " + p.keys.describe(key) + ": ";
  if (!p.envelopes) throw std::invalid_argument(name + "a margin needs Config::envelope");
  if (!(margin >= 0 && std::isfinite(margin))) {
    throw std::invalid_argument(name + "its margin is " + std::to_string(margin) +
                                ", but must be finite and not negative");
  }
}

// ---- the step

template <class Scalar, int Dim>
bool KeyedEngine<Scalar, Dim>::step_with_envelopes() {
  Parts& p = *parts_;
  bool ran = false;  // the core's part of a query, which is to be committed or cancelled
  const auto cancel = [&] {
    if (ran) p.core.cancel_step();
    p.envelopes->cancel_step(p.objects());
  };
  bool query = false;
  try {
    query = p.envelopes->begin_step(p.objects(), p.core.executor());
    if (query) {
      if (!p.objects().anything_queued()) p.order.rest();
      ran = p.core.run_step();
      if (!ran) {
        cancel();
        return false;
      }
    }
    if (p.filter ? !p.filter->run_step(query) : !query) p.order.rest();
  } catch (...) {
    cancel();
    throw;
  }
  if (query) p.core.commit_step();
  p.envelopes->end_step(p.core.executor());
  if (p.filter) {
    p.filter->commit_step(p.begins(), p.ends());
  } else if (query) {
    p.core.count_events(p.begins(), p.ends());
  }
  return true;
}

// ---- what is asked for

template <class Scalar, int Dim>
EnvelopeReport KeyedEngine<Scalar, Dim>::envelope_report() const {
  const Parts& p = parts("envelope_report");
  EnvelopeReport report;
  if (!p.envelopes) return report;
  report = p.envelopes->report();
  report.candidates = p.core.pair_count();
  return report;
}

// A step that is no query leaves the core as it was, and its events are those of the filter.
template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::add_envelope_stats(Stats& stats) const {
  const Parts& p = *parts_;
  stats.steps = p.envelopes->steps();
  stats.bytes_objects += p.envelopes->bytes();
  if (!p.envelopes->queried()) {
    stats.step = StepCounters{};
    for (StageTime& stage : stats.stages) stage.seconds = 0;
  }
  if (p.filter) p.filter->add_stats(stats);
}

template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::validate_envelopes() const {
  const Parts& p = *parts_;
  p.envelopes->validate(p.objects());
  if (p.objects().anything_queued()) return;  // for the next query
  p.core.validate();
  if (p.filter) p.filter->validate();
}

}  // namespace sweepgrid
