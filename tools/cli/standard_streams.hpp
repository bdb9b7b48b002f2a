#pragma once

#include <cstdio>
#include <string>

namespace sweepgrid {

/// To be called before any file is opened. Descriptors 0, 1 and 2 that the process was started without are taken by
/// what cannot be used, so that no file gets such a number and what is printed for people with it.
void hold_standard_streams();

/// Throws std::system_error that names the stream unless all that was printed to `stream`, stdout or stderr, was
/// written.
void flush_standard_stream(std::FILE* stream);

/// Prints `text` and sees to it that it was written. Throws likewise.
void write_standard_stream(std::FILE* stream, const std::string& text);

/// Prints a message for people to stderr. Where that fails there is nobody to tell, and the work goes on.
void show_on_stderr(const std::string& text);

}  // namespace sweepgrid
