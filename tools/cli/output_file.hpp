#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace sweepgrid {

/// A file that is there as a whole or not at all: written under another name beside `path`, which it takes when it is
/// committed. "-" is the standard output; devices and pipes are written to as they are.
/// Every error throws std::system_error with the path.
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
  [[noreturn]] void fail() const;

  std::string path_;
  std::string target_;     // path_, links followed
  std::string temporary_;  // empty when the target itself is written to
  std::FILE* file_ = nullptr;
};

}  // namespace sweepgrid
