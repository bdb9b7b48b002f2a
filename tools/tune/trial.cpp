#include "tune/trial.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "accuracy/accuracy_tally.hpp"
#include "measure/stopwatch.hpp"
#include "study/accuracy/play.hpp"

namespace sweepgrid::tune {
namespace {

constexpr double kMilliPerNano = 1e-6;
constexpr double kMilli = 1e3;
constexpr std::uint64_t kMostPairs = 4000000;  // that a step may report

double part(std::uint64_t some, std::uint64_t all) {
  return all == 0 ? 0 : static_cast<double>(some) / static_cast<double>(all);
}

/// Looks at the pairs of a window, and at whether it is worth going on.
class PairCheck {
 public:
  PairCheck(const Window& window, const Demand& demand, double limit_ms, Trial& trial)
      : window_(window), limit_ms_(limit_ms * static_cast<double>(window.measured())), trial_(trial) {
    narrow_ms_ = kMilliPerNano * demand.narrow_ns;
  }

  bool listen(const Events<SceneKey>& events) {
    const std::vector<ScenePair>& pairs = pairs_.step(events);
    if (pairs.size() > kMostPairs) {
      trial_.given_up = fmt::format("{} pairs in a step", pairs.size());
      return false;
    }
    if (step_ < window_.first_measured()) {
      ++step_;
      watch_ = ThreadStopwatch();
      return true;
    }
    tally_.step(window_.scene.truths.front().pairs[step_], pairs);
    ++step_;
    // Pairs are certain; a clock, on which this function is, too, must be far beyond.
    const double narrow_ms = narrow_ms_ * static_cast<double>(tally_.result().reported_pairs);
    constexpr double kFar = 4;
    if (narrow_ms <= limit_ms_ && kMilli * watch_.seconds() <= kFar * limit_ms_) return true;
    trial_.given_up = "clearly dearer";
    return false;
  }

  void add_to_trial() const {
    const accuracy::Accuracy& accuracy = tally_.result();
    trial_.true_pairs += accuracy.true_pairs;
    trial_.reported_pairs += accuracy.reported_pairs;
    trial_.missed_pairs += accuracy.missed_pairs;
    trial_.extra_pairs += accuracy.extra_pairs;
  }

 private:
  const Window& window_;
  double limit_ms_;
  double narrow_ms_ = 0;
  Trial& trial_;
  accuracy::PairsOfEvents pairs_;
  accuracy::AccuracyTally tally_;
  ThreadStopwatch watch_;
  std::size_t step_ = 0;
};

}  // namespace

double Trial::step_ms() const {
  const double sum = std::accumulate(least_ms.begin(), least_ms.end(), 0.0);
  return least_ms.empty() ? 0 : sum / static_cast<double>(least_ms.size());
}

double Trial::candidates() const {
  return least_ms.empty() ? 0 : static_cast<double>(reported_pairs) / static_cast<double>(least_ms.size());
}

double Trial::total_ms(double narrow_ns) const { return step_ms() + kMilliPerNano * narrow_ns * candidates(); }

double Trial::missed() const { return part(missed_pairs, true_pairs); }
double Trial::extra() const { return part(extra_pairs, reported_pairs); }

bool met(const Trial& trial, const Demand& demand) {
  return trial.given_up.empty() && trial.missed() <= demand.missed && (!demand.extra || trial.extra() <= *demand.extra);
}

PlayRound round_player(const SceneSample& sample, const Demand& demand) {
  return [&sample, &demand](const Candidate& candidate, Trial& trial, double limit_ms) {
    const EngineSetup setup = candidate.setup(sample, demand.threads);
    const bool first = trial.rounds++ == 0;
    std::size_t measured = 0;
    for (const Window& window : sample.windows) {
      PairCheck check(window, demand, limit_ms, trial);
      const study::Play play = study::play(
          setup, window.scene, [&](const Events<SceneKey>& events) { return !first || check.listen(events); });
      if (!trial.given_up.empty()) return;
      for (std::size_t k = window.first_measured(); k < play.times_ms.size(); ++k, ++measured) {
        if (first) {
          trial.least_ms.push_back(play.times_ms[k]);
        } else {
          trial.least_ms[measured] = std::min(trial.least_ms[measured], play.times_ms[k]);
        }
      }
      if (first) check.add_to_trial();
      trial.grids = play.stats.grids;
      trial.cell_size = play.stats.cell_size;
    }
  };
}

}  // namespace sweepgrid::tune
