#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <sweepgrid/scheduler/schedule_simulator.hpp>

#include "study/machine_costs.hpp"

namespace sweepgrid::study {

/// Part of the time of a stage's tasks that is bound by memory, by stage name.
using MemoryShares = std::map<std::string, double>;

/// A policy and what it is charged, as a curve of the report.
struct Forecast {
  const char* id;    ///< in JSON
  const char* name;  ///< for people
  SchedulePolicy policy;
  bool memory;  ///< under the roof that was measured here; else memory grows with the workers
};

inline constexpr std::array<Forecast, 4> kForecasts = {{
    {"stealing", "work stealing", SchedulePolicy::kWorkStealing, false},
    {"stealing_roof", "work stealing, this machine's memory", SchedulePolicy::kWorkStealing, true},
    {"static", "static ranges", SchedulePolicy::kStaticRanges, false},
    {"longest_first", "longest first", SchedulePolicy::kLongestFirst, false},
}};

/// What one stage comes to over all steps, in seconds.
struct StageForecast {
  std::string name;
  double work = 0;     ///< of its tasks
  double serial = 0;   ///< of its serial parts
  double wall = 0;     ///< by work stealing: from the end of the stage before
  double longest = 0;  ///< sum over steps of the longest task
  double tasks = 0;    ///< in a step, on average
};

/// What the simulator makes of recorded steps on so many workers.
struct Prediction {
  int workers = 1;
  double work = 0;  ///< sums over steps, in seconds
  double span = 0;
  double serial = 0;
  std::map<std::string, std::vector<double>> step_seconds;  ///< by id of the forecast
  std::vector<StageForecast> stages;                        ///< in the order of the step

  /// Of all steps.
  [[nodiscard]] double seconds(const std::string& forecast) const;
};

/// `steps`: recorded for `workers` workers; their memory shares are set here.
[[nodiscard]] Prediction predict(std::vector<WorkGraph> steps, int workers, const MachineCosts& costs,
                                 const MemoryShares& shares);

void to_json(nlohmann::json& json, const Prediction& prediction);
void from_json(const nlohmann::json& json, Prediction& prediction);

}  // namespace sweepgrid::study
