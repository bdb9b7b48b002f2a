#pragma once

#include <cstdint>
#include <ios>
#include <stdexcept>

#include <boost/iostreams/categories.hpp>
#include <boost/iostreams/operations.hpp>

namespace sweepgrid {

/// Follows the framing of compressed zstd data (RFC 8878, section 3.1) without decompressing it, so that a cut is
/// noticed: Boost's zstd filter takes the end of the file for the end of the data wherever it comes.
class ZstdFraming {
 public:
  /// Takes the next `count` compressed bytes.
  void feed(const char* bytes, std::streamsize count);

  /// All frames that began have ended.
  [[nodiscard]] bool complete() const { return part_ == Part::kMagic && have_ == 0; }

 private:
  enum class Part { kMagic, kDescriptor, kHeader, kBlockHeader, kBlock, kChecksum, kSkipSize, kSkipped, kForeign };

  void expect(Part part, std::uint64_t size);
  void finish_part();

  Part part_ = Part::kMagic;
  std::uint64_t need_ = 4;   // bytes of this part
  std::uint64_t have_ = 0;   // of them seen
  std::uint64_t value_ = 0;  // the first 8 of them as a little-endian number
  bool checksum_ = false;
  bool last_block_ = false;
};

/// Boost.Iostreams filter that passes compressed zstd data on and throws when it ends inside a frame.
class ZstdCutDetector {
 public:
  using char_type = char;
  using category = boost::iostreams::multichar_input_filter_tag;

  template <class Source>
  std::streamsize read(Source& source, char* to, std::streamsize size) {
    const std::streamsize count = boost::iostreams::read(source, to, size);
    if (count > 0) framing_.feed(to, count);
    if (count < 0 && !framing_.complete()) throw std::runtime_error("the file ends inside a zstd frame");
    return count;
  }

 private:
  ZstdFraming framing_;
};

}  // namespace sweepgrid
