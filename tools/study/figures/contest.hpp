#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "study/figures/system.hpp"

namespace sweepgrid::study {

/// Several systems over one scene.
struct ContestPlan {
  std::string scene;  ///< a generator with its parameters but `steps`, which follow from the rounds
  std::vector<SystemSpec> systems;
  int rounds = 1;
  int steps_per_round = 1;
};

/// What one system came to.
struct Entry {
  std::string system;
  double x = 0;                 ///< where it stands on the figure's axis
  std::vector<double> seconds;  ///< per step, the mean of a round, for each round; processor time of the thread
  Work work;                    ///< in all rounds together
  std::uint64_t steps = 0;      ///< in all rounds together
  std::string complaint;        ///< how its pairs at the end differ from those of the OverlapOracle; empty: not at all

  [[nodiscard]] double per_step(std::uint64_t count) const {
    return static_cast<double>(count) / static_cast<double>(steps);
  }
};

struct Contest {
  std::string scene;
  std::uint64_t pairs = 0;  ///< that overlap at the end
  std::vector<Entry> entries;
};

/// Plays the scene: a start and one round that do not count, and then the rounds. In each, every system has its turn
/// with the same steps. At the end each system's pairs are compared with the oracle's.
[[nodiscard]] Contest play(const ContestPlan& plan);

[[nodiscard]] nlohmann::json to_json(const Contest& contest);
/// Throws nlohmann::json::exception when `from` is not of to_json().
[[nodiscard]] Contest contest_of(const nlohmann::json& from);

}  // namespace sweepgrid::study
