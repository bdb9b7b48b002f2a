#include "tune/reasons.hpp"

#include <limits>

#include <fmt/format.h>

namespace sweepgrid::tune {
namespace {

constexpr double kPercent = 100;

std::string totals(const Contest& contest, const Contender& one, const Contender& other) {
  return fmt::format("{:.4g} ms a step in total, against {:.4g} with", contest.total_ms(one), contest.total_ms(other));
}

/// The cheapest contender that differs from the best as `differs` says; null without one.
template <class Differs>
const Contender* next_best(const Contest& contest, const Contender& best, Differs&& differs) {
  const Contender* next = nullptr;
  for (const Contender& other : contest.contenders()) {
    if (!other.trial.given_up.empty() || !differs(other.candidate, best.candidate)) continue;
    if (next == nullptr || contest.total_ms(other) < contest.total_ms(*next)) next = &other;
  }
  return next;
}

std::string compared(const Contest& contest, const Contender& best, const Contender* next, const std::string& with) {
  if (next == nullptr) return "nothing else was left to compare with";
  const bool plainer = contest.total_ms(*next) < contest.total_ms(best);
  return fmt::format("{} {}{}", totals(contest, best, *next), with,
                     plainer ? ", too little to tell the engine something for it" : "");
}

Reason numbers(const SceneSample& sample, const SceneFacts& facts, const Contest& contest, const Contender& best) {
  const Door door = best.candidate.door;
  const Contender* next =
      next_best(contest, best, [](const Candidate& a, const Candidate& b) { return a.door != b.door; });
  std::string because = compared(contest, best, next, next == nullptr ? "" : door_name(next->candidate.door));
  because += facts.floats ? "; every coordinate of the sample is a float"
                          : fmt::format(
                                "; not every coordinate is a float; objects are up to {:.4g} widths from the "
                                "origin",
                                facts.farthest);
  if (is_float(door) && sample.info.format == "aabbs") because += ", as the format has it: nothing is rounded";
  return {"numbers", door_name(door), because};
}

Reason axes(const SceneSample& sample, const SceneFacts& facts, const Contest& contest, const Contender& best) {
  const std::vector<std::size_t>& axes = best.candidate.axes;
  if (sample.info.dim == 2) return {"axes", axes_name(axes), "the scene has two dimensions"};
  const Contender* next =
      next_best(contest, best, [](const Candidate& a, const Candidate& b) { return a.axes != b.axes; });
  std::string because;
  if (next != nullptr) because = totals(contest, best, *next) + " " + axes_name(next->candidate.axes) + "; ";
  if (axes.size() == 2) {
    const std::size_t left_out = 3 - axes[0] - axes[1];
    const double pairs = facts.pairs_without[left_out];
    because += fmt::format(
        "the scene is flat: without {} there are {:.4g} pairs of boxes instead of {:.4g} ({:.4g} % "
        "more), which the narrow phase is charged for",
        "xyz"[left_out], pairs, facts.pairs, kPercent * (pairs / facts.pairs - 1));
  } else {
    because += fmt::format("there are {:.4g} pairs of boxes; without x {:.4g}, without y {:.4g}, without z {:.4g}",
                           facts.pairs, facts.pairs_without[0], facts.pairs_without[1], facts.pairs_without[2]);
  }
  return {"axes", axes_name(axes), because};
}

Reason envelopes(const SceneSample& sample, const SceneFacts& facts, const Contest& contest, const Contender& best) {
  const EnvelopeChoice& envelope = best.candidate.envelope;
  const Contender* next = next_best(contest, best, [](const Candidate& a, const Candidate& b) {
    return envelope_name(a.envelope) != envelope_name(b.envelope);
  });
  std::string because = compared(contest, best, next, next == nullptr ? "" : envelope_name(next->candidate.envelope));
  because += fmt::format("; of {:.4g} objects, {:.4g} change in a step", facts.objects, facts.updates);
  if (facts.updates > 0) {
    because += fmt::format(", by {:.4g} widths (median; at most {:.4g})", facts.displacement, facts.most_displacement);
  }
  if (envelope && envelope->margin > 0) {
    because += fmt::format("; {:.4g} of these leave a margin of {:.4g} widths",
                           updates_outside(sample, envelope->margin), envelope->margin);
  }
  if (best.trial.extra_pairs > 0) {
    because += fmt::format("; {:.4g} % of the reported pairs are extra", kPercent * best.trial.extra());
  }
  return {"envelopes", envelope_name(envelope), because};
}

Reason cells(const Contest& contest, const Contender& best) {
  const Contender* next = next_best(
      contest, best, [](const Candidate& a, const Candidate& b) { return cells_name(a.cells) != cells_name(b.cells); });
  return {"cells", cells_name(best.candidate.cells),
          compared(contest, best, next, next == nullptr ? "" : cells_name(next->candidate.cells))};
}

// How many levels there are is the engine's doing.
Reason grid(const SceneFacts& facts, const Contender& best) {
  const double ratio =
      facts.least_edge > 0 ? facts.most_edge / facts.least_edge : std::numeric_limits<double>::infinity();
  const std::string sizes = fmt::format("the longest edges of boxes are {:.4g} to {:.4g} (1 to {:.4g})",
                                        facts.least_edge, facts.most_edge, ratio);
  if (best.trial.grids == 0) {
    return {"grid", "none",
            fmt::format("{}; so much moves that the engine sweeps all objects and keeps no cells", sizes)};
  }
  const bool uniform = best.trial.grids == 1;
  return {"grid", uniform ? "one level" : fmt::format("{} levels", best.trial.grids),
          fmt::format("{}; the engine made {} of cells, the finest {:.4g} wide in its units, by itself", sizes,
                      uniform ? "one grid" : fmt::format("{} grids", best.trial.grids), best.trial.cell_size)};
}

}  // namespace

std::string why_not_worthwhile(const EnvelopeOptions& envelope, const SceneSample& sample, const SceneFacts& facts) {
  if (facts.updates <= 0) return "nothing moves";
  if (envelope.margin > 0 && envelope.stride == 1) {
    constexpr double kNearlyAll = 0.7;
    const double outside = updates_outside(sample, envelope.margin);
    if (outside > kNearlyAll * facts.updates) {
      return fmt::format("{:.4g} of {:.4g} updates a step would leave the margin", outside, facts.updates);
    }
  }
  if (envelope.margin_steps > 0) {
    // Each object has a margin of its own, so a few that are fast do not matter to the others.
    constexpr double kWidest = 1;
    const double speed = mean_speed(sample, envelope.stride);
    const double margin = envelope.margin_steps * speed;
    if (margin > kWidest) {
      return fmt::format("margins would be {:.4g} widths in the mean: objects go by {:.4g} in a step", margin, speed);
    }
  }
  if (envelope.stride > 1 && envelope.margin > 0 && facts.most_displacement > envelope.margin) {
    return fmt::format("objects move by up to {:.4g} widths in a step, out of the margin: every step would be a query",
                       facts.most_displacement);
  }
  return "";
}

std::string why_rejected(const Contender& other, const Contender& best, const Demand& demand) {
  if (!other.trial.given_up.empty()) return "given up: " + other.trial.given_up;
  if (!met(other.trial, demand)) {
    return fmt::format("{:.4g} % missed, {:.4g} % extra: more than allowed", kPercent * other.trial.missed(),
                       kPercent * other.trial.extra());
  }
  const double ratio = other.trial.total_ms(demand.narrow_ns) / best.trial.total_ms(demand.narrow_ns);
  return fmt::format("{:.3f} times the total of the chosen one", ratio);
}

std::vector<Reason> reasons(const SceneSample& sample, const SceneFacts& facts, const Demand& demand,
                            const Contest& contest, const Contender& best) {
  const Guarantee promise = promised(best.candidate, sample.info, demand);
  return {numbers(sample, facts, contest, best),
          axes(sample, facts, contest, best),
          envelopes(sample, facts, contest, best),
          cells(contest, best),
          grid(facts, best),
          {"guarantee", guarantee_name(promise),
           fmt::format("of {}, whatever the scene does (engine/ACCURACY.md); asked for: {}", truth_name(demand.truth),
                       demand_text(demand))}};
}

}  // namespace sweepgrid::tune
