#include "rounds.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace sweepgrid::bench {

Rounds::Rounds(const std::vector<Contestant>& contestants, const SceneScript& script, int rounds)
    : runs_(contestants.size()), complaints_(contestants.size()) {
  const SceneTruth truth(script);
  for (const Contestant& contestant : contestants) names_.push_back(contestant.name);
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < contestants.size(); ++i) {
      const Run& run = runs_[i].emplace_back(play(contestants[i].make, script, truth));
      for (const std::string& complaint : run.complaints) {
        complaints_[i].push_back(fmt::format("round {}, {}", round + 1, complaint));
      }
    }
  }
  compare_events();
}

// Pairs are known from the boxes; how often they begin and end is only known by what the others say.
void Rounds::compare_events() {
  const auto first =
      std::find_if(runs_.begin(), runs_.end(), [](const auto& runs) { return runs[0].events.has_value(); });
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    for (const Run& run : runs_[i]) {
      if (!run.events || *run.events == *first->front().events) continue;
      complaints_[i].push_back(fmt::format("{} begins and {} ends, but {} has {} and {}", run.events->begins,
                                           run.events->ends, names_[first - runs_.begin()],
                                           first->front().events->begins, first->front().events->ends));
    }
  }
}

}  // namespace sweepgrid::bench
