#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <sweepgrid/engine/stats.hpp>

namespace sweepgrid::bench {

/// A count by the name that files and tables give it.
struct NamedCount {
  std::string name;
  std::uint64_t count = 0;
};

/// All exact counters of `counters`, those of its cells included.
[[nodiscard]] std::vector<NamedCount> named_counts(const StepCounters& counters);

/// The parts of the bytes that `stats` tells.
[[nodiscard]] std::vector<NamedCount> named_bytes(const Stats& stats);

}  // namespace sweepgrid::bench
