#pragma once

#include <string>
#include <vector>

namespace sweepgrid {

/// A file as a command was told it.
struct NamedFile {
  std::string name;  ///< of the option or argument, as messages call it
  std::string path;  ///< empty: not told
};

/// Throws std::invalid_argument that names both when an output is one file with another output, with an input, or with
/// what the standard output or error was sent to. Files are one under whatever names: links of either kind and other
/// spellings, there already or not. Devices such as /dev/null keep nothing, so several outputs may share one.
void check_distinct(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs);

/// Those of the scenes that are files, as inputs. Throws SceneError like parse_generator().
[[nodiscard]] std::vector<NamedFile> files_among(const std::vector<std::string>& scenes);

}  // namespace sweepgrid
