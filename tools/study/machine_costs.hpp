#pragma once

#include <nlohmann/json.hpp>

#include <sweepgrid/scheduler/schedule_simulator.hpp>

#include "measure/spread.hpp"

namespace sweepgrid::study {

/// What this machine charges for going parallel, by micro-benchmarks of the executor and of memory. Times in seconds.
/// Of times the lower fifth is told, from the least to the median of what was tried: being set aside only adds. A
/// median of 0: other programs left no moment to measure it.
struct MachineCosts {
  int threads = 1;  ///< that took part: as many as the machine has
  Spread spawn;     ///< a task of a large loop with nothing in its body
  Spread steal;     ///< from the start of a loop to a second worker's first task, right after another loop
  Spread wake;      ///< how much longer that is after a long pause
  Spread spin;      ///< the pause after which a worker sleeps; its spread: the pauses tried on either side
  Spread barrier;   ///< from the end of a stage's last task to the start of the next stage's plan
  Spread stream;    ///< bytes per second that one thread copies, read and written
  Spread roof;      ///< how many times that all threads copy together
  Spread cores;     ///< how many times one thread's pure arithmetic all threads do together: less than `threads` on a
                    ///< machine that is not quiet, or whose threads share cores

  /// `memory`: whether the roof counts, or memory is taken to grow with the workers.
  [[nodiscard]] ScheduleCosts schedule_costs(bool memory) const;
};

/// Takes about three seconds.
[[nodiscard]] MachineCosts measure_machine_costs();

void to_json(nlohmann::json& json, const MachineCosts& costs);
void from_json(const nlohmann::json& json, MachineCosts& costs);

}  // namespace sweepgrid::study
