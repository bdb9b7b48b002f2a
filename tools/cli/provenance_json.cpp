#include "cli/provenance_json.hpp"

#include <nlohmann/json.hpp>

#include "cli/build_info.hpp"
#include "cli/machine_info.hpp"

namespace sweepgrid {

nlohmann::ordered_json build_json() {
  const BuildInfo build = build_info();
  return {{"version", build.version},
          {"commit", build.commit},
          {"compiler", build.compiler},
          {"flags", build.flags},
          {"build_type", build.build_type}};
}

nlohmann::ordered_json machine_json() {
  const MachineInfo machine = machine_info();
  return {{"system", machine.system},
          {"cpu", machine.cpu},
          {"cores", machine.cores},
          {"memory_bytes", machine.memory_bytes}};
}

}  // namespace sweepgrid
