// Bytes as compressed content: what a stream makes of them is what zlib, liblzma or libzstd make of them in one go;
// what is cut off or damaged is refused. The first byte chooses between bytes that are compressed already and bytes
// that are compressed here, and then cut, damaged or followed by more.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include <lzma.h>
#include <zlib.h>
#include <zstd.h>

#include "finding.hpp"
#include "fuzz_input.hpp"
#include "scenes/byte_stream.hpp"

namespace sweepgrid::fuzz {
namespace {

/// Content beyond this is not looked at.
constexpr std::size_t kMost = std::size_t{1} << 21;
constexpr std::size_t kPart = 4096;

enum class Kind { kNone, kGzip, kXz, kZstd };

/// What a library says of compressed bytes.
struct Verdict {
  enum { kWhole, kBad, kUnknown } is = kUnknown;
  std::string content;
};

template <class Bytes>
auto* bytes_of(Bytes& text) {
  return reinterpret_cast<const std::uint8_t*>(text.data());
}

Verdict gunzip(const std::string& bytes) {
  Verdict verdict;
  z_stream stream{};
  require(inflateInit2(&stream, 15 + 16) == Z_OK, "zlib does not start");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  stream.next_in = const_cast<std::uint8_t*>(bytes_of(bytes));
  stream.avail_in = static_cast<unsigned>(bytes.size());
  std::string part(kPart, '\0');
  while (verdict.content.size() < kMost) {
    stream.next_out = reinterpret_cast<std::uint8_t*>(part.data());
    stream.avail_out = static_cast<unsigned>(part.size());
    const int status = inflate(&stream, Z_NO_FLUSH);
    verdict.content.append(part, 0, part.size() - stream.avail_out);
    if (status == Z_STREAM_END) {
      if (stream.avail_in == 0) {
        verdict.is = Verdict::kWhole;
        return verdict;
      }
      // What follows a member and is none may be padding or damage.
      if (stream.avail_in < 2 || stream.next_in[0] != 0x1f || stream.next_in[1] != 0x8b) return verdict;
      inflateReset(&stream);
    } else if (status != Z_OK) {
      verdict.is = Verdict::kBad;  // Z_BUF_ERROR: the end is missing
      return verdict;
    }
  }
  return verdict;
}

Verdict unxz(const std::string& bytes) {
  Verdict verdict;
  lzma_stream stream = LZMA_STREAM_INIT;
  require(lzma_stream_decoder(&stream, 1U << 26U, LZMA_CONCATENATED) == LZMA_OK, "liblzma does not start");
  const std::unique_ptr<lzma_stream, void (*)(lzma_stream*)> end(&stream, lzma_end);
  stream.next_in = bytes_of(bytes);
  stream.avail_in = bytes.size();
  std::string part(kPart, '\0');
  while (verdict.content.size() < kMost) {
    stream.next_out = reinterpret_cast<std::uint8_t*>(part.data());
    stream.avail_out = part.size();
    const lzma_ret status = lzma_code(&stream, LZMA_FINISH);
    verdict.content.append(part, 0, part.size() - stream.avail_out);
    if (status == LZMA_OK) continue;
    if (status == LZMA_STREAM_END) verdict.is = Verdict::kWhole;
    if (status == LZMA_DATA_ERROR || status == LZMA_BUF_ERROR) verdict.is = Verdict::kBad;
    return verdict;  // of other kinds of data readers may know more or less
  }
  return verdict;
}

Verdict unzstd(const std::string& bytes) {
  Verdict verdict;
  const std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(), ZSTD_freeDStream);
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  std::string part(kPart, '\0');
  while (verdict.content.size() < kMost) {
    ZSTD_outBuffer out{part.data(), part.size(), 0};
    const std::size_t wanted = ZSTD_decompressStream(stream.get(), &out, &in);
    verdict.content.append(part, 0, out.pos);
    verdict.is = Verdict::kBad;
    if (ZSTD_isError(wanted) != 0) return verdict;
    if (in.pos == in.size && (wanted == 0 || out.pos < out.size)) {
      if (wanted == 0) verdict.is = Verdict::kWhole;
      return verdict;
    }
  }
  verdict.is = Verdict::kUnknown;
  return verdict;
}

Kind kind_of(std::string_view compression) {
  if (compression == "gzip") return Kind::kGzip;
  if (compression == "xz") return Kind::kXz;
  return compression == "zstd" ? Kind::kZstd : Kind::kNone;
}

Verdict verdict_of(std::string_view compression, const std::string& bytes) {
  switch (kind_of(compression)) {
    case Kind::kGzip:
      return gunzip(bytes);
    case Kind::kXz:
      return unxz(bytes);
    case Kind::kZstd:
      return unzstd(bytes);
    default:
      return {Verdict::kWhole, bytes};
  }
}

std::string gzip(std::string text) {
  z_stream stream{};
  require(deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) == Z_OK, "zlib does not start");
  std::string result(deflateBound(&stream, text.size()) + 32, '\0');
  stream.next_in = reinterpret_cast<std::uint8_t*>(text.data());
  stream.avail_in = static_cast<unsigned>(text.size());
  stream.next_out = reinterpret_cast<std::uint8_t*>(result.data());
  stream.avail_out = static_cast<unsigned>(result.size());
  require(deflate(&stream, Z_FINISH) == Z_STREAM_END, "zlib does not end");
  result.resize(stream.total_out);
  deflateEnd(&stream);
  return result;
}

std::string xz(const std::string& text) {
  std::string result(lzma_stream_buffer_bound(text.size()), '\0');
  std::size_t size = 0;
  require(lzma_easy_buffer_encode(0, LZMA_CHECK_CRC32, nullptr, bytes_of(text), text.size(),
                                  reinterpret_cast<std::uint8_t*>(result.data()), &size, result.size()) == LZMA_OK,
          "liblzma does not compress");
  result.resize(size);
  return result;
}

std::string zstd(const std::string& text, bool checksum) {
  const std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> context(ZSTD_createCCtx(), ZSTD_freeCCtx);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, checksum ? 1 : 0);
  std::string result(ZSTD_compressBound(text.size()), '\0');
  const std::size_t size = ZSTD_compress2(context.get(), result.data(), result.size(), text.data(), text.size());
  require(ZSTD_isError(size) == 0, "libzstd does not compress");
  result.resize(size);
  return result;
}

std::string compress(Kind kind, const std::string& text, bool checksum) {
  return kind == Kind::kGzip ? gzip(text) : kind == Kind::kXz ? xz(text) : zstd(text, checksum);
}

std::string make_bytes(Input& input) {
  const auto kind = static_cast<Kind>(input.below(4));
  if (kind == Kind::kNone) return input.rest();
  const std::uint8_t flags = input.byte();
  const std::size_t at = input.byte() + 256U * input.byte();
  std::string text = input.rest();
  // Long content without long inputs.
  if ((flags & 1U) != 0) {
    while (text.size() < 100'000 && !text.empty()) text += text;
  }
  std::string bytes = compress(kind, text, (flags & 2U) != 0);
  if ((flags & 4U) != 0) bytes += compress(kind, text.substr(0, at % (text.size() + 1)), (flags & 8U) != 0);
  if ((flags & 16U) != 0) bytes.resize(at % (bytes.size() + 1));
  if ((flags & 32U) != 0 && !bytes.empty()) bytes[at % bytes.size()] ^= static_cast<char>(1U << (at >> 13U));
  return bytes;
}

/// The content by the stream; absent when the data are damaged or cut off.
std::optional<std::string> read(ByteStream& stream) {
  std::string content;
  std::string part(kPart, '\0');
  while (content.size() < kMost) {
    const std::string peeked(stream.peek(16));
    const std::size_t count = stream.read(part.data(), part.size());
    require(peeked == std::string_view(part).substr(0, std::min(count, peeked.size())), "peek() is not what follows");
    content.append(part, 0, count);
    require(stream.offset() == content.size(), "offset() is wrong");
    if (count < part.size()) break;
  }
  if (content.size() < kMost && !stream.damage().empty()) return std::nullopt;
  return content;
}

}  // namespace
}  // namespace sweepgrid::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sweepgrid::fuzz;  // NOLINT(google-build-using-namespace)
  Input input({data, size});
  const std::string bytes = make_bytes(input);
  sweepgrid::ByteStream stream(std::make_unique<std::stringbuf>(bytes), "input");
  const std::optional<std::string> found = read(stream);
  Verdict expected = verdict_of(stream.compression(), bytes);
  if (planted("bit") && !expected.content.empty()) expected.content.back() ^= 1;
  if (expected.is == Verdict::kBad) require(!found, "damaged or cut data are taken");
  if (expected.is != Verdict::kWhole) return 0;
  require(found.has_value(), "whole data are refused");
  require(*found == expected.content, "the content is another");
  return 0;
}
