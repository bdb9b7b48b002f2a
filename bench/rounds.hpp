#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "contestants.hpp"
#include "measure/spread.hpp"
#include "run.hpp"
#include "system.hpp"

namespace sweepgrid::bench {

/// Several contestants over one script, in turn, round after round. Ratios are of runs in the same round, because the
/// machine's speed differs more from one round to the next than within one.
class Rounds {
 public:
  Rounds(const std::vector<Contestant>& contestants, const SceneScript& script, int rounds);

  [[nodiscard]] std::size_t size() const { return runs_.size(); }
  [[nodiscard]] const std::string& name(std::size_t contestant) const { return names_[contestant]; }
  /// Of the last round; what is exact is the same in all.
  [[nodiscard]] const Run& last(std::size_t contestant) const { return runs_[contestant].back(); }

  /// Of a figure of Run, a member or a function, over the rounds.
  template <class Figure>
  [[nodiscard]] Spread of(std::size_t contestant, Figure figure) const {
    std::vector<double> values;
    for (const Run& run : runs_[contestant]) values.push_back(std::invoke(figure, run));
    return spread(std::move(values));
  }

  /// How many times smaller it is than that of the first contestant in the same round.
  template <class Figure>
  [[nodiscard]] Spread times_less(std::size_t contestant, Figure figure) const {
    std::vector<double> values;
    for (std::size_t round = 0; round < runs_[contestant].size(); ++round) {
      const double own = std::invoke(figure, runs_[contestant][round]);
      if (own > 0) values.push_back(std::invoke(figure, runs_[0][round]) / own);
    }
    return spread(std::move(values));
  }

  /// What is wrong with the results of a contestant, a sentence each.
  [[nodiscard]] const std::vector<std::string>& complaints(std::size_t contestant) const {
    return complaints_[contestant];
  }

 private:
  void compare_events();

  std::vector<std::string> names_;
  std::vector<std::vector<Run>> runs_;  // by contestant, then round
  std::vector<std::vector<std::string>> complaints_;
};

}  // namespace sweepgrid::bench
