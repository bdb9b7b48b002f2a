#pragma once

#include <algorithm>
#include <string>

#include <sweepgrid/engine/keyed_engine.hpp>
#include <sweepgrid/engine/keyed_pairs.hpp>
#include <sweepgrid/sap/invariant.hpp>

namespace sweepgrid {

// E2 and E3: events are sorted and unique; a pair that has just begun overlaps now; one that has just ended does not,
// unless new objects took over its keys.
template <class Scalar, int Dim>
void KeyedEngine<Scalar, Dim>::validate_events() const {
  const Parts& p = *parts_;
  const KeyedPairs begins(p.keys, p.events.begins);
  const KeyedPairs ends(p.keys, p.events.ends);
  for (const KeyedPairs* events : {&ends, &begins}) {
    const std::size_t unordered = events->first_unordered();
    require_invariant(unordered == events->size(), "E3",
                      [&] { return "events are not sorted and unique at " + events->describe(unordered); });
  }
  const KeyedPairs now(p.keys, p.filter ? p.filter->pairs() : p.core.pairs());
  for (std::size_t i = 0; i < begins.size(); ++i) {
    require_invariant(now.contains(begins[i]), "E2",
                      [&] { return "a begin without an overlap: " + begins.describe(i); });
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    require_invariant(begins.contains(ends[i]) == now.contains(ends[i]), "E3",
                      [&] { return "an end of a pair that overlaps: " + ends.describe(i); });
  }
}

}  // namespace sweepgrid
