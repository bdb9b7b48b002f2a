#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace sweepgrid::study {

/// Something that a lane did for a while, in seconds.
struct TraceSlice {
  std::size_t lane = 0;
  std::string name;
  std::string category;  ///< what viewers filter by
  double start = 0;
  double duration = 0;
};

/// Lanes that belong together, such as the workers of one run. Viewers show them under one heading.
struct TraceProcess {
  std::string name;
  std::vector<std::string> lanes;
  std::vector<TraceSlice> slices;
};

/// JSON in the Trace Event format, which Perfetto (ui.perfetto.dev) and chrome://tracing open: complete events, in
/// microseconds, and the names of processes and lanes.
[[nodiscard]] std::string trace_events(const std::vector<TraceProcess>& processes);

}  // namespace sweepgrid::study
