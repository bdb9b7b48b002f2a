#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

#include <boost/iostreams/filtering_streambuf.hpp>

namespace sweepgrid {

/// The content of a file or of other bytes, decompressed on the way if its first bytes are those of gzip, xz or zstd.
/// Every error is a SceneError with the file's name; data that end before the compressed stream does are one.
class ByteStream {
 public:
  explicit ByteStream(const std::string& path);
  /// `path`: what errors call the bytes.
  ByteStream(std::unique_ptr<std::streambuf> bytes, std::string path);

  [[nodiscard]] const std::string& path() const { return path_; }
  /// "none", "gzip", "xz" or "zstd".
  [[nodiscard]] const std::string& compression() const { return compression_; }

  /// The next bytes without taking them: `count`, or fewer at the end. At most 4096. Good until the next call.
  [[nodiscard]] std::string_view peek(std::size_t count);

  /// Takes up to `count` bytes; fewer only at the end.
  std::size_t read(char* to, std::size_t count);

  /// Takes a line without its end; false at the end. A last line without an end is an error, because it may have been
  /// cut inside a number. `line` is good until the next call.
  bool read_line(std::string_view& line);

  /// Bytes of content taken so far.
  [[nodiscard]] std::uint64_t offset() const { return offset_; }
  /// Number of the line that was taken last, from 1.
  [[nodiscard]] std::uint64_t line() const { return line_; }

  /// Throws SceneError: "PATH: byte N: reason", or "PATH: line N: reason".
  [[noreturn]] void fail_at_byte(std::uint64_t byte, std::string_view reason) const;
  [[noreturn]] void fail_at_line(std::string_view reason) const;

 private:
  // Makes room behind the unread bytes and fills it; false at the end.
  bool fill();

  std::string path_;
  std::string compression_;
  std::unique_ptr<std::streambuf> bytes_;
  boost::iostreams::filtering_istreambuf content_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  // unread bytes: [begin_, end_)
  std::size_t end_ = 0;
  bool at_end_ = false;
  std::uint64_t offset_ = 0;
  std::uint64_t line_ = 0;
};

}  // namespace sweepgrid
