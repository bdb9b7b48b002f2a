#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/decompressor.hpp"

namespace sweepgrid {

/// The content of a file, a pipe or other bytes, decompressed on the way if its first bytes are those of gzip, xz or
/// zstd. Every error is a SceneError with the file's name. Data that are damaged or cut off, and reading that fails,
/// end the content: what came before can be taken, and only then is it an error.
class ByteStream {
 public:
  explicit ByteStream(const std::string& path);
  /// `path`: what errors call the bytes.
  ByteStream(std::unique_ptr<std::streambuf> bytes, std::string path);

  [[nodiscard]] const std::string& path() const { return path_; }
  /// "none", "gzip", "xz" or "zstd".
  [[nodiscard]] const std::string& compression() const { return compression_; }
  /// Bytes of the whole content, where that is known: not of pipes and compressed files.
  [[nodiscard]] std::optional<std::uint64_t> size() const { return size_; }

  /// The next bytes without taking them: `count`, or fewer at the end. At most 4096. Good until the next call.
  [[nodiscard]] std::string_view peek(std::size_t count);

  /// Takes up to `count` bytes; fewer only at the end.
  std::size_t read(char* to, std::size_t count);

  /// Takes a line without its end; false at the end, of which damage() tells more. A last line without an end is an
  /// error, because it may have been cut inside a number. `line` is good until the next call.
  bool read_line(std::string_view& line);

  /// Bytes of content taken so far.
  [[nodiscard]] std::uint64_t offset() const { return offset_; }
  /// Number of the line that was taken last, from 1.
  [[nodiscard]] std::uint64_t line() const { return line_; }

  /// What is wrong with the data or with reading them; empty when nothing is. To be asked at the end.
  [[nodiscard]] const std::string& damage() const { return damage_; }

  /// Throws SceneError: "PATH: byte N: reason", or "PATH: line N: reason".
  [[noreturn]] void fail_at_byte(std::uint64_t byte, std::string_view reason) const;
  [[noreturn]] void fail_at_line(std::string_view reason) const;
  /// The same at the byte or line that was taken last, with the reason "the file ends WHERE", and why if it is known.
  [[noreturn]] void fail_at_end_in_bytes(std::string_view where) const;
  [[noreturn]] void fail_at_end_in_lines(std::string_view where) const;

 private:
  // Makes room behind the unread bytes and fills it; false at the end.
  bool fill();
  // Content and bytes as they are in the file: at least one, or none at the end.
  std::size_t content(std::span<char> to);
  std::size_t bytes(std::span<char> to);
  [[nodiscard]] std::string end_reason(std::string_view where) const;

  std::string path_;
  std::string compression_;
  std::optional<std::uint64_t> size_;
  std::unique_ptr<std::streambuf> bytes_;
  std::unique_ptr<Decompressor> decompressor_;  // null: none
  std::vector<char> packed_;                    // compressed bytes that wait: [packed_begin_, packed_end_)
  std::size_t packed_begin_ = 0;
  std::size_t packed_end_ = 0;
  bool bytes_ended_ = false;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  // unread bytes: [begin_, end_)
  std::size_t end_ = 0;
  bool at_end_ = false;
  std::string damage_;
  std::uint64_t offset_ = 0;
  std::uint64_t line_ = 0;
};

}  // namespace sweepgrid
