#pragma once

#include <algorithm>
#include <cstdint>
#include <exception>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <sweepgrid/engine/engine.hpp>
#include <sweepgrid/engine/envelope_box.hpp>

#include "engine_oracle.hpp"

/// Engines with envelopes beside the brute-force oracle, which knows only the boxes that the client gave.
namespace sweepgrid::oracle {

using Pairs = std::vector<Pair<std::uint64_t>>;

inline bool pair_less(const Pair<std::uint64_t>& a, const Pair<std::uint64_t>& b) {
  return std::pair(a.first, a.second) < std::pair(b.first, b.second);
}

/// Pairs of `wanted` that `found` lacks; both sorted.
inline Pairs missed(const Pairs& wanted, const Pairs& found) {
  Pairs result;
  std::set_difference(wanted.begin(), wanted.end(), found.begin(), found.end(), std::back_inserter(result), pair_less);
  return result;
}

/// The pairs that a client knows who hears nothing but events. Says what was wrong with them.
class Listener {
 public:
  std::string hear(const Events<std::uint64_t>& events) {
    for (const auto& pair : events.ends) {
      const auto known = std::lower_bound(pairs_.begin(), pairs_.end(), pair, pair_less);
      if (known == pairs_.end() || !(*known == pair)) return "an end without a begin";
      pairs_.erase(known);
    }
    for (const auto& pair : events.begins) {
      const auto place = std::lower_bound(pairs_.begin(), pairs_.end(), pair, pair_less);
      if (place != pairs_.end() && *place == pair) return "a second begin";
      pairs_.insert(place, pair);
    }
    return {};
  }
  [[nodiscard]] const Pairs& pairs() const { return pairs_; }

 private:
  Pairs pairs_;
};

/// What the envelopes say by brute force.
template <class Scalar, int Dim>
Pairs pairs_of_envelopes(const Engine<Scalar, Dim>& engine, const EngineModel<Scalar, Dim>& model) {
  std::vector<std::uint64_t> keys;
  std::vector<Box<Scalar, Dim>> envelopes;
  for (const auto& [key, box] : model.boxes()) {
    keys.push_back(key);
    envelopes.push_back(engine.envelope(engine.find(key).value()));
  }
  Pairs pairs;
  every_overlap(envelopes, [&](std::size_t a, std::size_t b) { pairs.push_back({keys[a], keys[b]}); });
  return pairs;
}

/// Whether every pair has an object that the report names.
template <class Scalar, int Dim>
bool all_named(const Pairs& pairs, const Engine<Scalar, Dim>& engine) {
  const auto outside = engine.envelope_report().outside;
  const auto named = [&](std::uint64_t key) {
    const auto handle = engine.find(key);
    return handle && std::find(outside.begin(), outside.end(), *handle) != outside.end();
  };
  return std::all_of(pairs.begin(), pairs.end(), [&](const auto& p) { return named(p.first) || named(p.second); });
}

/// What must be true after a step, whatever the options: nothing is missed but of objects that the report names, with
/// `exact` nothing is too much, pairs are what events say, and boxes are those that the client gave.
template <class Scalar, int Dim>
std::string compare_envelopes(const EnvelopeOptions& options, const Engine<Scalar, Dim>& engine,
                              const EngineModel<Scalar, Dim>& model, const Listener& listener) {
  const Pairs pairs = engine.pairs();
  std::string wrong = difference("pairs by events", pairs, listener.pairs());
  if (!wrong.empty()) return wrong;
  const EnvelopeReport report = engine.envelope_report();
  const Pairs missing = missed(model.pairs(), pairs);
  if (!all_named(missing, engine)) return std::to_string(missing.size()) + " pairs are missed, and nobody says so";
  if (options.exact) {
    if (!missed(pairs, model.pairs()).empty()) return "there are pairs that do not overlap";
    if (report.candidates < pairs.size()) return "there are fewer candidates than pairs";
  } else if (options.stride == 1) {
    wrong = difference("pairs of envelopes", pairs_of_envelopes(engine, model), pairs);
    if (!wrong.empty()) return wrong;
  }
  if (engine.stats().pairs != pairs.size()) return "stats() has another number of pairs";
  if (options.stride == 1 && !report.outside.empty()) return "the report names objects, and every step is a query";
  for (const auto& [key, box] : model.boxes()) {
    const Handle handle = engine.find(key).value();
    if (engine.box(handle) != box) return "box() of an object is wrong";
    const bool outside = std::find(report.outside.begin(), report.outside.end(), handle) != report.outside.end();
    if (!outside && !holds(engine.envelope(handle), box)) return "an envelope does not hold its box";
  }
  try {
    engine.validate();
  } catch (const std::exception& error) {
    return std::string("validate(): ") + error.what();
  }
  return {};
}

/// Plays a script with envelopes; says what was wrong and when, nothing when all was well. `stream`: all events.
template <class Scalar, int Dim, class Script>
std::string play_envelopes(const Config& config, Script script, int steps, Calls calls,
                           std::vector<Events<std::uint64_t>>* stream = nullptr) {
  Engine<Scalar, Dim> engine(config);
  EngineModel<Scalar, Dim> model;
  Listener listener;
  const EnvelopeOptions& options = config.envelope.value();
  for (int step = 0; step < steps; ++step) {
    std::string wrong;
    try {
      const EngineOps<Scalar, Dim> ops = script.next();
      queue(engine, ops, calls);
      model.apply(ops);
      const Events<std::uint64_t>& expected = model.step();
      const Events<std::uint64_t>& events = engine.step();
      if (stream != nullptr) stream->push_back(events);
      // Exact are the events of every step, or if it does not query at once, of every step until an object was outside.
      const bool exact =
          options.exact && (options.on_violation == OnViolation::kQuery || engine.envelope_report().violations == 0);
      if (exact || (options.stride == 1 && options.exact)) wrong = difference(expected, events);
      if (wrong.empty()) wrong = listener.hear(events);
      if (wrong.empty()) wrong = compare_envelopes(options, engine, model, listener);
    } catch (const std::exception& error) {
      wrong = std::string("exception: ") + error.what();
    }
    if (!wrong.empty()) return "step " + std::to_string(step) + ": " + wrong;
  }
  return {};
}

}  // namespace sweepgrid::oracle
