#pragma once

#include <string>

namespace sweepgrid {

/// What the path of an output leads to, once all links are followed.
struct OutputPlace {
  enum class Kind {
    kDescriptor,  ///< one that this process holds: "-", /dev/stdout, /dev/fd/3, the >(...) of a shell
    kDevice,      ///< is there and is no regular file: a device, a named pipe
    kFile         ///< a regular file, or nothing yet
  };
  Kind kind = Kind::kFile;
  int descriptor = -1;  ///< of kDescriptor
  std::string path;     ///< of the others; a link to nothing leads to what it names
};

/// Throws std::system_error that names `path` when its links lead in a ring.
[[nodiscard]] OutputPlace find_output_place(const std::string& path);

/// Whether what is written to `path` goes to the standard output: "-", /dev/stdout and the like.
[[nodiscard]] bool is_standard_output(const std::string& path);

}  // namespace sweepgrid
