#include "tune/exhaustive.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "measure/stopwatch.hpp"

namespace sweepgrid::tune {
namespace {

struct Entry {
  Candidate candidate;
  Trial trial;
};

/// A loop over everything, axes outermost: the first candidate of each tells how many pairs all the others report at
/// least.
class Search {
 public:
  Search(const SceneSample& whole, const Demand& demand, const PlayRound& play)
      : info_(whole.info), demand_(demand), play_(play), space_(candidate_space(whole.info)) {}

  ExhaustiveResult run() {
    const ThreadStopwatch watch;
    for (const std::vector<std::size_t>& axes : space_.axes) search_axes(axes);
    result_.measured = entries_.size();
    result_.seconds = watch.seconds();
    return result_;
  }

  /// The cheapest `count` of those that met the demand.
  [[nodiscard]] std::vector<Entry> cheapest(std::size_t count) const {
    std::vector<Entry> entries;
    for (const Entry& entry : entries_) {
      if (met(entry.trial, demand_)) entries.push_back(entry);
    }
    std::sort(entries.begin(), entries.end(), [this](const Entry& a, const Entry& b) {
      return a.trial.total_ms(demand_.narrow_ns) < b.trial.total_ms(demand_.narrow_ns);
    });
    entries.resize(std::min(entries.size(), count));
    return entries;
  }

 private:
  void search_axes(const std::vector<std::size_t>& axes) {
    const std::size_t before = entries_.size();
    std::size_t skipped = 0;
    bool hopeless = false;
    for (const EnvelopeChoice& envelope : space_.envelopes) {
      for (const Door door : space_.doors) {
        for (const CellChoice& cells : space_.cells) {
          const Candidate candidate{axes, door, envelope, cells};
          if (!may_meet(candidate, info_, demand_)) continue;
          if (hopeless) {
            ++skipped;
            continue;
          }
          measure(candidate);
          // What any other envelope leaves on these axes is a superset of this, or misses pairs, too.
          const bool fewest = tight(envelope) && door == Door::kDouble && entries_.size() == before + 1;
          hopeless = fewest && narrow_alone(entries_.back().trial) > least_total_;
        }
      }
    }
    result_.ruled_out += skipped;
  }

  static bool tight(const EnvelopeChoice& envelope) {
    return !envelope || (envelope->margin <= 0 && envelope->margin_steps <= 0 && envelope->stride == 1);
  }

  void measure(const Candidate& candidate) {
    Entry& entry = entries_.emplace_back(Entry{candidate, {}});
    play_(candidate, entry.trial, std::numeric_limits<double>::infinity());
    if (met(entry.trial, demand_)) least_total_ = std::min(least_total_, entry.trial.total_ms(demand_.narrow_ns));
  }

  [[nodiscard]] double narrow_alone(const Trial& trial) const {
    if (!trial.given_up.empty()) return std::numeric_limits<double>::infinity();
    return trial.total_ms(demand_.narrow_ns) - trial.step_ms();
  }

  const SceneInfo& info_;
  const Demand& demand_;
  const PlayRound& play_;
  CandidateSpace space_;
  std::vector<Entry> entries_;
  double least_total_ = std::numeric_limits<double>::infinity();
  ExhaustiveResult result_;
};

}  // namespace

ExhaustiveResult search_exhaustively(const SceneSample& whole, const Demand& demand, const Candidate& chosen,
                                     const PlayRound& play, int last_rounds) {
  constexpr std::size_t kAhead = 6;
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  Search search(whole, demand, play);
  ExhaustiveResult result = search.run();
  std::vector<Entry> ahead = search.cheapest(kAhead);
  ahead.push_back({chosen, {}});
  for (int round = 0; round < last_rounds; ++round) {
    for (Entry& entry : ahead) play(entry.candidate, entry.trial, kNoLimit);
  }
  result.chosen_trial = ahead.back().trial;
  const auto best = std::min_element(ahead.begin(), ahead.end(), [&](const Entry& a, const Entry& b) {
    return a.trial.total_ms(demand.narrow_ns) < b.trial.total_ms(demand.narrow_ns);
  });
  result.best = best->candidate;
  result.best_trial = best->trial;
  return result;
}

}  // namespace sweepgrid::tune
