#include "cli/standard_streams.hpp"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace sweepgrid {
namespace {

[[noreturn]] void fail(std::FILE* stream, int error) {
  const char* const name = stream == stderr ? "the standard error" : "the standard output";
  throw std::system_error(error, std::generic_category(), std::string("cannot write ") + name);
}

}  // namespace

void hold_standard_streams() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    // The lowest number that is free is this one. Opened the wrong way round: reading and writing fail as without it.
    static_cast<void>(open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY));
  }
}

void flush_standard_stream(std::FILE* stream) {
  const bool failed_before = std::ferror(stream) != 0;
  if (std::fflush(stream) != 0) fail(stream, errno);
  if (failed_before) fail(stream, EIO);  // why is not known any more
}

void write_standard_stream(std::FILE* stream, const std::string& text) {
  if (std::fputs(text.c_str(), stream) < 0) fail(stream, errno);
  flush_standard_stream(stream);
}

void show_on_stderr(const std::string& text) { static_cast<void>(std::fputs(text.c_str(), stderr)); }

}  // namespace sweepgrid
