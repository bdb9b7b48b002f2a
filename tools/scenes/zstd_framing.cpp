#include "scenes/zstd_framing.hpp"

#include <algorithm>

namespace sweepgrid {
namespace {

constexpr std::uint64_t kFrameMagic = 0xFD2FB528U;
constexpr std::uint64_t kSkippableMagic = 0x184D2A50U;  // and the 15 numbers after it

// Bytes of the frame header that follow its descriptor byte.
std::uint64_t header_size(std::uint64_t descriptor) {
  constexpr std::uint64_t kDictionaryIdSize[] = {0, 1, 2, 4};
  constexpr std::uint64_t kContentSizeSize[] = {0, 2, 4, 8};
  const bool single_segment = (descriptor >> 5 & 1) != 0;
  const std::uint64_t size_flag = descriptor >> 6 & 3;
  const std::uint64_t content_size = size_flag == 0 && single_segment ? 1 : kContentSizeSize[size_flag];
  return (single_segment ? 0 : 1) + kDictionaryIdSize[descriptor & 3] + content_size;
}

}  // namespace

void ZstdFraming::feed(const char* bytes, std::streamsize count) {
  while (count > 0 && part_ != Part::kForeign) {
    if (have_ < 8) {
      value_ |= std::uint64_t{static_cast<unsigned char>(*bytes)} << (8 * have_);
    }
    // Past the first bytes, which make up the value, a part is skipped at once.
    const auto taken = have_ < 8 ? std::uint64_t{1} : std::min(need_ - have_, static_cast<std::uint64_t>(count));
    have_ += taken;
    bytes += taken;
    count -= static_cast<std::streamsize>(taken);
    if (have_ == need_) finish_part();
  }
}

void ZstdFraming::expect(Part part, std::uint64_t size) {
  part_ = part;
  need_ = size;
  have_ = 0;
  value_ = 0;
  if (size == 0) finish_part();
}

void ZstdFraming::finish_part() {
  const std::uint64_t value = value_;
  switch (part_) {
    case Part::kMagic:
      if (value == kFrameMagic) return expect(Part::kDescriptor, 1);
      if ((value & ~std::uint64_t{15}) == kSkippableMagic) return expect(Part::kSkipSize, 4);
      part_ = Part::kForeign;  // the decompressor reports it
      return;
    case Part::kDescriptor:
      checksum_ = (value >> 2 & 1) != 0;
      return expect(Part::kHeader, header_size(value));
    case Part::kHeader:
      return expect(Part::kBlockHeader, 3);
    case Part::kBlockHeader: {
      constexpr std::uint64_t kRunLength = 1;  // one byte stands for the whole block
      last_block_ = (value & 1) != 0;
      return expect(Part::kBlock, (value >> 1 & 3) == kRunLength ? 1 : value >> 3);
    }
    case Part::kBlock:
      if (!last_block_) return expect(Part::kBlockHeader, 3);
      return expect(Part::kChecksum, checksum_ ? 4 : 0);
    case Part::kSkipSize:
      return expect(Part::kSkipped, value);
    case Part::kChecksum:
    case Part::kSkipped:
      return expect(Part::kMagic, 4);
    case Part::kForeign:
      return;
  }
}

}  // namespace sweepgrid
