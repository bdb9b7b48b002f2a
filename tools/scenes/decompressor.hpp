#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace sweepgrid {

/// Undoes one kind of compression piece by piece. Streams that follow each other are one content.
class Decompressor {
 public:
  struct Progress {
    std::size_t taken = 0;  ///< bytes of the input
    std::size_t given = 0;  ///< bytes of the output
  };

  Decompressor() = default;
  Decompressor(const Decompressor&) = delete;
  Decompressor& operator=(const Decompressor&) = delete;
  virtual ~Decompressor() = default;

  /// Goes on until `in` is used up or `out` is full. `last`: there is no input behind `in`.
  /// Throws std::runtime_error with the library's reason when the data are damaged.
  virtual Progress run(std::string_view in, std::span<char> out, bool last) = 0;

  /// All streams that began have ended. Data that end while this is false are cut off.
  [[nodiscard]] virtual bool complete() const = 0;
};

/// Most bytes that compression_of() looks at.
inline constexpr std::size_t kLongestMagic = 6;

/// "gzip", "xz" or "zstd" for data that start like that, else "none".
[[nodiscard]] std::string compression_of(std::string_view start);

/// Null for "none".
[[nodiscard]] std::unique_ptr<Decompressor> make_decompressor(std::string_view compression);

}  // namespace sweepgrid
