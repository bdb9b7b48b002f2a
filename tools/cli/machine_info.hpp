#pragma once

#include <cstdint>
#include <string>

namespace sweepgrid {

/// The machine that runs this program. Empty or 0 where unknown.
struct MachineInfo {
  std::string system;  ///< of uname: name, release, architecture
  std::string cpu;
  unsigned cores = 0;  ///< hardware threads that this process may use
  std::uint64_t memory_bytes = 0;
};

[[nodiscard]] MachineInfo machine_info();

/// Most memory that this process has held at once since the latest call of reset_peak_memory() that the system granted,
/// in bytes of resident set.
[[nodiscard]] std::uint64_t peak_memory();
void reset_peak_memory();

}  // namespace sweepgrid
