#include "tune/contest.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace sweepgrid::tune {
namespace {

constexpr double kAgain = 1.25;    // times the best total: what may yet turn out to be the best
constexpr double kNothing = 1.02;  // times the best total: what is as cheap
constexpr double kHopeless = 2;    // times the best total: what need not be played to the end
constexpr int kRounds = 3;
constexpr int kLastRounds = 5;
constexpr std::size_t kMostAgain = 5;

/// How many choices are not what an engine does when it is told nothing.
int told(const Candidate& candidate) {
  const CellChoice& cells = candidate.cells;
  return (candidate.envelope ? 1 : 0) + (cells.kind != CellKind::kRows ? 1 : 0) + (cells.population ? 1 : 0) +
         (cells.reduction != Reduction::kSingleReporter ? 1 : 0);
}

}  // namespace

double shortfall(const Trial& trial, const Demand& demand) {
  if (!trial.given_up.empty()) return std::numeric_limits<double>::infinity();
  const double extra = demand.extra ? std::max(0.0, trial.extra() - *demand.extra) : 0;
  return std::max(0.0, trial.missed() - demand.missed) + extra;
}

bool Contest::better(const Contender& a, const Contender& b) const {
  const double short_a = shortfall(a.trial, demand_);
  const double short_b = shortfall(b.trial, demand_);
  return short_a != short_b ? short_a < short_b : total_ms(a) < total_ms(b);
}

std::size_t Contest::enter(const Candidate& candidate) {
  const std::string name = candidate.name();
  for (std::size_t i = 0; i < contenders_.size(); ++i) {
    if (contenders_[i].name == name) return i;
  }
  double limit = std::numeric_limits<double>::infinity();
  for (const Contender& known : contenders_) {
    if (shortfall(known.trial, demand_) <= 0) limit = std::min(limit, kHopeless * total_ms(known));
  }
  Contender& contender = contenders_.emplace_back(Contender{candidate, name, {}});
  play_(candidate, contender.trial, limit);
  return contenders_.size() - 1;
}

std::vector<std::size_t> Contest::near_best(const std::vector<std::size_t>& some, double factor,
                                            std::size_t most) const {
  double best = std::numeric_limits<double>::infinity();
  for (const std::size_t i : some) {
    if (met(contenders_[i].trial, demand_)) best = std::min(best, total_ms(contenders_[i]));
  }
  std::vector<std::size_t> near;
  std::vector<double> totals;
  for (const std::size_t i : some) {
    if (!met(contenders_[i].trial, demand_) || total_ms(contenders_[i]) > factor * best) continue;
    near.push_back(i);
    totals.push_back(total_ms(contenders_[i]));
  }
  if (near.size() <= most) return near;
  std::nth_element(totals.begin(), totals.begin() + static_cast<std::ptrdiff_t>(most), totals.end());
  std::erase_if(near, [&](std::size_t i) { return total_ms(contenders_[i]) >= totals[most]; });
  return near;
}

void Contest::play_again(const std::vector<std::size_t>& some, int rounds) {
  if (some.size() < 2) return;
  for (int round = 1; round < rounds; ++round) {
    for (const std::size_t i : some) {
      Trial& trial = contenders_[i].trial;
      if (trial.rounds <= round) play_(contenders_[i].candidate, trial, std::numeric_limits<double>::infinity());
    }
  }
}

std::size_t Contest::compete(const std::vector<Candidate>& candidates) {
  std::vector<std::size_t> places;
  places.reserve(candidates.size());
  for (const Candidate& candidate : candidates) places.push_back(enter(candidate));
  play_again(near_best(places, kAgain, kMostAgain), kRounds);
  const std::vector<std::size_t> ahead = near_best(places, kNothing, places.size());
  const auto best = std::min_element(places.begin(), places.end(), [&](std::size_t a, std::size_t b) {
    return better(contenders_[a], contenders_[b]);
  });
  const std::size_t place = ahead.empty() ? *best : ahead.front();
  return static_cast<std::size_t>(std::find(places.begin(), places.end(), place) - places.begin());
}

const Contender& Contest::decide() {
  std::vector<std::size_t> all(contenders_.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  play_again(near_best(all, kAgain, kMostAgain), kLastRounds);
  const std::vector<std::size_t> ahead = near_best(all, kNothing, all.size());
  const std::vector<std::size_t>& some = ahead.empty() ? all : ahead;
  return contenders_[*std::min_element(some.begin(), some.end(), [&](std::size_t i, std::size_t j) {
    const Contender& a = contenders_[i];
    const Contender& b = contenders_[j];
    const int told_a = ahead.empty() ? 0 : told(a.candidate);
    const int told_b = ahead.empty() ? 0 : told(b.candidate);
    return told_a != told_b ? told_a < told_b : better(a, b);
  })];
}

const Contender& Contest::of(const Candidate& candidate) const {
  const std::string name = candidate.name();
  const auto found = std::find_if(contenders_.begin(), contenders_.end(),
                                  [&](const Contender& contender) { return contender.name == name; });
  if (found == contenders_.end()) throw std::logic_error(name + " was not measured");
  return *found;
}

}  // namespace sweepgrid::tune
