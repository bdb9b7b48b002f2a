#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tune/candidate.hpp"
#include "tune/demand.hpp"
#include "tune/trial.hpp"

namespace sweepgrid::tune {

/// A candidate that was measured.
struct Contender {
  Candidate candidate;
  std::string name;
  Trial trial;
};

/// All that has been measured so far, and who is ahead: those that meet the demand before those that do not, then by
/// the total. Candidates are measured once each and, where they are near to the best, in turn with it again.
class Contest {
 public:
  Contest(const Demand& demand, const PlayRound& play) : demand_(demand), play_(play) {}

  /// Measures those that are new. Returns the index of the best of `candidates`: the first that is as cheap as the
  /// cheapest but for a few per cent, so that what comes first is not given up for nothing.
  std::size_t compete(const std::vector<Candidate>& candidates);

  /// Measures those near to the best of all some rounds more, and returns the cheapest; of those that are as cheap but
  /// for a few per cent, the plainest.
  const Contender& decide();

  [[nodiscard]] const std::vector<Contender>& contenders() const { return contenders_; }
  [[nodiscard]] const Contender& of(const Candidate& candidate) const;
  [[nodiscard]] double total_ms(const Contender& contender) const {
    return contender.trial.total_ms(demand_.narrow_ns);
  }

 private:
  std::size_t enter(const Candidate& candidate);
  /// Whether the first is better; equal ones are not.
  [[nodiscard]] bool better(const Contender& a, const Contender& b) const;
  /// Indices of those whose total is within `factor` of the best of `some`, in the order of `some`; of more than `most`
  /// the cheapest. Empty when nobody met the demand.
  [[nodiscard]] std::vector<std::size_t> near_best(const std::vector<std::size_t>& some, double factor,
                                                   std::size_t most) const;
  void play_again(const std::vector<std::size_t>& some, int rounds);

  const Demand& demand_;
  const PlayRound& play_;
  std::vector<Contender> contenders_;
};

/// How much a trial lacks to meet the demand; 0: it meets it.
[[nodiscard]] double shortfall(const Trial& trial, const Demand& demand);

}  // namespace sweepgrid::tune
