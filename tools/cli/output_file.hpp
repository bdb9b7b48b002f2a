#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "cli/temporary_path.hpp"

namespace sweepgrid {

/// An output of the program. A file is there as a whole or not at all: written under another name beside it,
/// FILE.PID.tmp, whose place it takes when it is committed; the name is removed when a signal ends the process. Links
/// are followed, also those to nothing; a file that is replaced keeps its permissions. "-", /dev/stdout and other
/// descriptors of the process, devices and pipes are written to as they are. Every error throws std::system_error with
/// the path.
class OutputFile {
 public:
  explicit OutputFile(std::string path);
  /// Without commit(), nothing is left.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view text);

  /// To be called once, last.
  void commit();

 private:
  // Of what was opened for writing.
  void take(int descriptor);
  [[noreturn]] void fail(int error) const;

  std::string path_;
  std::string target_;                      // path_, links followed
  std::optional<TemporaryPath> temporary_;  // absent when the target itself is written to
  std::FILE* file_ = nullptr;
};

}  // namespace sweepgrid
