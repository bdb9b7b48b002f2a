#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <sweepgrid/engine/handle.hpp>

namespace sweepgrid {

/// What a step between two queries does when a box has left what the latest query covered.
enum class OnViolation {
  kReport,  ///< says so in the report, and goes on: pairs may be missed until the next query
  kQuery,   ///< queries at once, with new envelopes for those that have left theirs: nothing is missed
};

/// Boxes that are wider than the objects' own, so that less changes from step to step, or that cover the way between
/// two steps. The engine works with these *envelopes*; with `exact` it then looks at the boxes that the client gave.
///
/// Every option says what it guarantees of the pairs after each step. T0: boxes overlap at the step. T1: boxes that
/// move linearly between two steps overlap at some time. Exact: these pairs and no others. Superset only: all of these,
/// and others. May miss: neither.
struct EnvelopeOptions {
  /// World units by which an envelope is wider than its box on every side when it is made; finite and not negative. An
  /// update to a box inside of the envelope then costs next to nothing, and pairs do not begin and end as boxes
  /// tremble. Superset only, of T0. For one object: Engine::insert() with a margin, Engine::set_margin().
  double margin = 0;

  /// Widens an object's margin by so many times its own speed: the largest displacement on any axis of late, where each
  /// counts for no more than the one before it, so that a jump does not count ("of late": it counts for seven eighths
  /// after `stride` steps; the one before was made at most 8 steps earlier). Finite and not negative. With a stride,
  /// 2 * (stride - 1) keeps boxes inside from query to query as long as no object becomes faster, and is updated at
  /// most once per step. Superset only, of T0.
  double margin_steps = 0;

  /// Envelopes also cover the way from the box of the previous step, moved linearly to the new one; or the way ahead,
  /// for updates with a displacement. The envelope of an object that stops shrinks at the next step by itself.
  /// Superset only, of T0 and of T1; of the way ahead as long as objects move as was said: the report names the others.
  bool swept = false;

  /// Queries are made by every stride-th step(), from the first one on; at least 1. The steps between have no events,
  /// and pairs() is what the latest query said. At a query, the envelopes of objects that moved and have used up half
  /// of their margin are made anew. Alone: exact at queries, else may miss. With margins: superset only, of T0, as long
  /// as no box leaves its envelope and no object is inserted between two queries; this is checked at every step.
  int stride = 1;

  /// What to do otherwise. kQuery: superset only, always. kReport: may miss while the report names objects.
  OnViolation on_violation = OnViolation::kReport;

  /// Pairs of envelopes are but candidates, of which every step tests those whose boxes changed: events and pairs() are
  /// those of an engine without envelopes. Exact, of T0. With a stride: exact as long as the report names no object; a
  /// pair that was missed begins at the next query. Not together with `swept`, which is about T1.
  bool exact = false;
};

/// What became of the promises of EnvelopeOptions.
struct EnvelopeReport {
  std::uint64_t steps = 0;       ///< so far
  std::uint64_t queries = 0;     ///< so far: steps at which envelopes were compared
  std::uint64_t early = 0;       ///< of these: made because of a violation, for those objects
  std::uint64_t violations = 0;  ///< so far: sum over steps of objects outside
  std::vector<Handle> outside;   ///< latest step: objects outside of what is covered, in the order of their indices
  double margin = 0;             ///< the widest that a query last gave to objects without one of their own
  std::size_t candidates = 0;    ///< pairs of envelopes as of the latest query
};

}  // namespace sweepgrid
