#include "scenes/decompressor.hpp"

#include <algorithm>
#include <limits>
#include <new>
#include <stdexcept>

#include <fmt/format.h>
#include <lzma.h>
#include <zlib.h>
#include <zstd.h>

namespace sweepgrid {
namespace {

// zlib only reads what next_in points to, but has no const there.
Bytef* input_of(std::string_view in) { return const_cast<Bytef*>(reinterpret_cast<const Bytef*>(in.data())); }

class GzipDecompressor : public Decompressor {
 public:
  GzipDecompressor() {
    constexpr int kGzipOnly = 16;
    if (inflateInit2(&stream_, MAX_WBITS + kGzipOnly) != Z_OK) throw std::bad_alloc();
  }
  ~GzipDecompressor() override { inflateEnd(&stream_); }

  Progress run(std::string_view in, std::span<char> out, bool /*last*/) override {
    if (in.empty() && complete_) return {};
    if (complete_) inflateReset(&stream_);
    // zlib counts in 32 bits.
    const auto available = [](std::size_t size) {
      return static_cast<uInt>(std::min<std::size_t>(size, std::numeric_limits<uInt>::max()));
    };
    stream_.next_in = input_of(in);
    stream_.avail_in = available(in.size());
    stream_.next_out = reinterpret_cast<Bytef*>(out.data());
    stream_.avail_out = available(out.size());
    const int result = inflate(&stream_, Z_NO_FLUSH);
    if (result == Z_MEM_ERROR) throw std::bad_alloc();
    // Z_BUF_ERROR: nothing was possible without more input.
    if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR) {
      throw std::runtime_error(stream_.msg != nullptr ? stream_.msg : fmt::format("zlib's error {}", result));
    }
    complete_ = result == Z_STREAM_END;
    return {available(in.size()) - stream_.avail_in, available(out.size()) - stream_.avail_out};
  }

  [[nodiscard]] bool complete() const override { return complete_; }

 private:
  z_stream stream_{};
  bool complete_ = false;
};

class XzDecompressor : public Decompressor {
 public:
  XzDecompressor() {
    // A damaged header must not ask for all memory; the largest dictionary of the presets takes 65 MB.
    constexpr std::uint64_t kMostMemory = std::uint64_t{1} << 30;
    if (lzma_stream_decoder(&stream_, kMostMemory, LZMA_CONCATENATED) != LZMA_OK) throw std::bad_alloc();
  }
  ~XzDecompressor() override { lzma_end(&stream_); }

  Progress run(std::string_view in, std::span<char> out, bool last) override {
    if (complete_) return {};
    stream_.next_in = reinterpret_cast<const std::uint8_t*>(in.data());
    stream_.avail_in = in.size();
    stream_.next_out = reinterpret_cast<std::uint8_t*>(out.data());
    stream_.avail_out = out.size();
    const lzma_ret result = lzma_code(&stream_, last ? LZMA_FINISH : LZMA_RUN);
    if (result == LZMA_MEM_ERROR) throw std::bad_alloc();
    // LZMA_BUF_ERROR: nothing was possible without more input.
    if (result != LZMA_OK && result != LZMA_STREAM_END && result != LZMA_BUF_ERROR) {
      throw std::runtime_error(reason(result));
    }
    complete_ = result == LZMA_STREAM_END;  // told only at the end of the input
    return {in.size() - stream_.avail_in, out.size() - stream_.avail_out};
  }

  [[nodiscard]] bool complete() const override { return complete_; }

 private:
  static std::string reason(lzma_ret result) {
    switch (result) {
      case LZMA_MEMLIMIT_ERROR:
        return "more than 1 GB of memory needed";
      case LZMA_FORMAT_ERROR:
        return "no xz data";
      case LZMA_OPTIONS_ERROR:
        return "unknown options";
      case LZMA_DATA_ERROR:
        return "wrong data";
      default:
        return fmt::format("liblzma's error {}", static_cast<int>(result));
    }
  }

  lzma_stream stream_ = LZMA_STREAM_INIT;
  bool complete_ = false;
};

class ZstdDecompressor : public Decompressor {
 public:
  ZstdDecompressor() : stream_(ZSTD_createDStream()) {
    if (stream_ == nullptr) throw std::bad_alloc();
  }
  ~ZstdDecompressor() override { ZSTD_freeDStream(stream_); }

  Progress run(std::string_view in, std::span<char> out, bool /*last*/) override {
    if (in.empty() && complete_) return {};
    ZSTD_inBuffer input = {in.data(), in.size(), 0};
    ZSTD_outBuffer output = {out.data(), out.size(), 0};
    const std::size_t left = ZSTD_decompressStream(stream_, &output, &input);
    if (ZSTD_isError(left) != 0) throw std::runtime_error(ZSTD_getErrorName(left));
    complete_ = left == 0;  // of the frame, which may be a skippable one
    return {input.pos, output.pos};
  }

  [[nodiscard]] bool complete() const override { return complete_; }

 private:
  ZSTD_DStream* stream_;
  bool complete_ = false;
};

}  // namespace

std::string compression_of(std::string_view start) {
  using namespace std::string_view_literals;
  if (start.starts_with("\x1f\x8b"sv)) return "gzip";
  if (start.starts_with("\xFD\x37zXZ\0"sv)) return "xz";
  if (start.starts_with("\x28\xb5\x2f\xfd"sv)) return "zstd";
  // A skippable frame, with which pzstd begins: 16 magic numbers from 0x184D2A50.
  const bool skippable = start.size() >= 4 && (static_cast<unsigned char>(start[0]) & 0xf0) == 0x50;
  if (skippable && start.substr(1).starts_with("\x2a\x4d\x18"sv)) return "zstd";
  return "none";
}

std::unique_ptr<Decompressor> make_decompressor(std::string_view compression) {
  if (compression == "gzip") return std::make_unique<GzipDecompressor>();
  if (compression == "xz") return std::make_unique<XzDecompressor>();
  if (compression == "zstd") return std::make_unique<ZstdDecompressor>();
  return nullptr;
}

}  // namespace sweepgrid
