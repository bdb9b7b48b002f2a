#pragma once

#include <string>

namespace sweepgrid {

/// How this program was built, as known when the build was configured. Empty where unknown.
struct BuildInfo {
  std::string version;
  std::string commit;
  std::string compiler;
  std::string flags;
  std::string build_type;
};

[[nodiscard]] BuildInfo build_info();

}  // namespace sweepgrid
