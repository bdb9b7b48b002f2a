#include "figures_file.hpp"

#include <fstream>
#include <stdexcept>

#include "cli/build_info.hpp"
#include "cli/machine_info.hpp"

namespace sweepgrid::bench {

void write_figures(const std::string& file, const std::string& schema, const nlohmann::ordered_json& figures) {
  const BuildInfo build = build_info();
  const MachineInfo machine = machine_info();
  nlohmann::ordered_json json = {{"schema", schema},
                                 {"schema_version", 1},
                                 {"build",
                                  {{"version", build.version},
                                   {"commit", build.commit},
                                   {"compiler", build.compiler},
                                   {"flags", build.flags},
                                   {"build_type", build.build_type}}},
                                 {"machine",
                                  {{"system", machine.system},
                                   {"cpu", machine.cpu},
                                   {"cores", machine.cores},
                                   {"memory_bytes", machine.memory_bytes}}}};
  json.update(figures);
  std::ofstream out(file);
  out << json.dump(2) << '\n';
  if (!out.flush()) throw std::runtime_error(file + ": cannot be written");
}

}  // namespace sweepgrid::bench
