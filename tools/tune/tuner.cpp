#include "tune/tuner.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "tune/contest.hpp"
#include "tune/reasons.hpp"

namespace sweepgrid::tune {
namespace {

constexpr double kMsPerNano = 1e-6;

class Tuner {
 public:
  Tuner(const SceneSample& sample, const SceneFacts& facts, const Demand& demand, const PlayRound& play)
      : sample_(sample), facts_(facts), demand_(demand), space_(candidate_space(sample.info)), contest_(demand, play) {}

  TuneResult tune() {
    current_ = {space_.axes[0], space_.doors[0], {}, space_.cells[0]};
    drop_what_promises_too_little();
    choose(space_.doors, &Candidate::door);
    choose(space_.cells, &Candidate::cells);
    space_.axes = worthwhile_axes();
    space_.envelopes = worthwhile_envelopes();
    choose_rest();
    // What was best with the other choices as they were then need not be with those that were made since.
    swaps_.clear();
    choose(space_.doors, &Candidate::door);
    choose(space_.cells, &Candidate::cells);
    choose_rest();
    try_runners_up();
    const Contender& best = contest_.decide();
    if (!met(best.trial, demand_)) {
      throw DemandNotMet(
          fmt::format("no configuration meets the demand ({}); nearest in the sample: {}, with {:.4g} % "
                      "missed and {:.4g} % extra pairs",
                      demand_text(demand_), best.name, 100 * best.trial.missed(), 100 * best.trial.extra()));
    }
    return result(best);
  }

 private:
  void reject(const std::string& what, const std::string& because) {
    result_.rejected.push_back({what, because, 0, 0});
  }

  // Whether a promise suffices is a matter of each respect by itself: what one breaks, no other mends.
  template <class Value, class Name>
  void drop(std::vector<Value>& values, Value Candidate::*member, Name&& name) {
    std::vector<Value> kept;
    for (const Value& value : values) {
      Candidate candidate = current_;
      candidate.*member = value;
      if (may_meet(candidate, sample_.info, demand_)) {
        kept.push_back(value);
      } else {
        const Guarantee promise = promised(candidate, sample_.info, demand_);
        reject(name(value), fmt::format("promises of {}: {}", truth_name(demand_.truth), guarantee_name(promise)));
      }
    }
    values = std::move(kept);
  }

  void drop_what_promises_too_little() {
    const std::string nearest = nearest_promise();
    drop(space_.envelopes, &Candidate::envelope, envelope_name);
    if (!space_.envelopes.empty()) current_.envelope = space_.envelopes[0];
    drop(space_.doors, &Candidate::door, door_name);
    drop(space_.axes, &Candidate::axes, axes_name);
    if (space_.envelopes.empty() || space_.doors.empty() || space_.axes.empty()) {
      throw DemandNotMet(
          fmt::format("no configuration meets the demand ({}); nearest: {}", demand_text(demand_), nearest));
    }
  }

  // For a demand that nothing meets.
  [[nodiscard]] std::string nearest_promise() const {
    Candidate nearest = current_;
    for (const EnvelopeChoice& envelope : space_.envelopes) {
      Candidate candidate = current_;
      candidate.envelope = envelope;
      if (promised(candidate, sample_.info, demand_) < promised(nearest, sample_.info, demand_)) nearest = candidate;
    }
    return fmt::format("{}, which promises of {}: {}", nearest.name(), truth_name(demand_.truth),
                       guarantee_name(promised(nearest, sample_.info, demand_)));
  }

  /// Measures all values of one respect, keeps the best, and remembers the runner-up.
  template <class Value>
  void choose(const std::vector<Value>& values, Value Candidate::*member) {
    std::vector<Candidate> candidates(values.size(), current_);
    for (std::size_t i = 0; i < values.size(); ++i) candidates[i].*member = values[i];
    const std::size_t best = contest_.compete(candidates);
    current_ = candidates[best];
    const Contender* second = nullptr;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const Contender& other = contest_.of(candidates[i]);
      if (i == best || !met(other.trial, demand_)) continue;
      if (second == nullptr || contest_.total_ms(other) < contest_.total_ms(*second)) second = &other;
    }
    constexpr double kClose = 1.2;
    if (second == nullptr || contest_.total_ms(*second) > kClose * contest_.total_ms(contest_.of(current_))) return;
    const Candidate runner_up = second->candidate;
    swaps_.push_back([member, value = runner_up.*member](Candidate& candidate) { candidate.*member = value; });
  }

  void choose_rest() {
    choose(space_.axes, &Candidate::axes);
    choose(space_.envelopes, &Candidate::envelope);
  }

  // Choices are made one after the other, but what is best of one may depend on a later one.
  void try_runners_up() {
    std::vector<Candidate> combined;
    for (std::size_t some = 1; some < std::size_t{1} << swaps_.size(); ++some) {
      Candidate& candidate = combined.emplace_back(current_);
      for (std::size_t i = 0; i < swaps_.size(); ++i) {
        if ((some >> i & 1) != 0) swaps_[i](candidate);
      }
    }
    if (!combined.empty()) contest_.compete(combined);
  }

  // Pairs are counted without an engine; when they alone cost more than all does now, no clock is needed.
  [[nodiscard]] std::vector<std::vector<std::size_t>> worthwhile_axes() {
    const double now = contest_.total_ms(contest_.of(current_));
    std::vector<std::vector<std::size_t>> kept = {space_.axes[0]};
    for (const std::vector<std::size_t>& axes : space_.axes) {
      if (axes == kept[0]) continue;
      const std::size_t left_out = 3 - axes[0] - axes[1];
      const double pairs = facts_.pairs_without[left_out];
      const double more = kMsPerNano * demand_.narrow_ns * (pairs - facts_.pairs);
      if (more < now) {
        kept.push_back(axes);
      } else {
        reject("axes " + axes_name(axes),
               fmt::format("{:.4g} pairs instead of {:.4g}: the narrow phase alone would take "
                           "{:.4g} ms more, and all takes {:.4g} ms now",
                           pairs, facts_.pairs, more, now));
      }
    }
    return kept;
  }

  [[nodiscard]] std::vector<EnvelopeChoice> worthwhile_envelopes() {
    std::vector<EnvelopeChoice> kept;
    for (const EnvelopeChoice& envelope : space_.envelopes) {
      const std::string why_not = envelope ? why_not_worthwhile(*envelope, sample_, facts_) : "";
      // What holds the place of nothing, such as swept boxes for T1, is measured in any case.
      if (why_not.empty() || kept.empty()) {
        kept.push_back(envelope);
      } else {
        reject(envelope_name(envelope), why_not);
      }
    }
    return kept;
  }

  TuneResult result(const Contender& best) {
    result_.chosen = best.candidate;
    result_.trial = best.trial;
    result_.guarantee = promised(best.candidate, sample_.info, demand_);
    result_.reasons = reasons(sample_, facts_, demand_, contest_, best);
    std::vector<Contender> others = contest_.contenders();
    std::sort(others.begin(), others.end(),
              [this](const Contender& a, const Contender& b) { return contest_.total_ms(a) < contest_.total_ms(b); });
    for (const Contender& other : others) {
      if (other.name == best.name) continue;
      result_.rejected.push_back(
          {other.name, why_rejected(other, best, demand_), other.trial.rounds, contest_.total_ms(other)});
    }
    return std::move(result_);
  }

  const SceneSample& sample_;
  const SceneFacts& facts_;
  const Demand& demand_;
  CandidateSpace space_;
  Contest contest_;
  Candidate current_;
  std::vector<std::function<void(Candidate&)>> swaps_;  // to the runner-up of one respect each
  TuneResult result_;
};

}  // namespace

TuneResult tune(const SceneSample& sample, const SceneFacts& facts, const Demand& demand, const PlayRound& play) {
  return Tuner(sample, facts, demand, play).tune();
}

}  // namespace sweepgrid::tune
