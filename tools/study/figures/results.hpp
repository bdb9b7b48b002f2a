#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "measure/spread.hpp"
#include "study/figures/contest.hpp"
#include "study/fit.hpp"

namespace sweepgrid::study {

/// What was measured, by figure, system and x. A figure that was not asked for has nothing, and what is asked of it
/// is absent.
class Results {
 public:
  using Figure = std::function<double(const Entry&)>;

  struct Played {
    std::string figure;
    Contest contest;
  };

  void add(std::string figure, Contest contest) { played_.push_back({std::move(figure), std::move(contest)}); }

  [[nodiscard]] const std::deque<Played>& all() const { return played_; }

  /// The systems of a figure in the order in which they appear.
  [[nodiscard]] std::vector<std::string> systems(const std::string& figure) const;

  /// A system's entries by growing x.
  [[nodiscard]] std::vector<const Entry*> series(const std::string& figure, const std::string& system) const;

  /// Null when it was not measured.
  [[nodiscard]] const Entry* find(const std::string& figure, const std::string& system, double x) const;

  /// How many times as long as `fast` `slow` takes, round by round.
  [[nodiscard]] std::optional<Spread> times_faster(const std::string& figure, double x, const std::string& slow,
                                                   const std::string& fast) const;

  /// As above at the greatest x where both were measured.
  [[nodiscard]] std::optional<Spread> times_faster_at_last(const std::string& figure, const std::string& slow,
                                                           const std::string& fast) const;

  /// The power law of `value` over x from `least_x` on; absent for fewer than three points with a positive value.
  [[nodiscard]] std::optional<PowerLaw> law(const std::string& figure, const std::string& system, const Figure& value,
                                            double least_x = 0) const;

  /// The least x from which on `first` takes longer than `second`, between two points by the logarithm of the ratio;
  /// infinity when it never does, absent when nothing was measured. 0: it does at the first point.
  [[nodiscard]] std::optional<double> crossing(const std::string& figure, const std::string& first,
                                               const std::string& second) const;

 private:
  std::deque<Played> played_;
};

/// Median seconds per step.
[[nodiscard]] inline double median_seconds(const Entry& entry) { return spread(entry.seconds).median; }

}  // namespace sweepgrid::study
