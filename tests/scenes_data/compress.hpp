#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include <lzma.h>
#include <zlib.h>
#include <zstd.h>

namespace sweepgrid::scene_files {

inline std::string gzip(const std::string& content) {
  z_stream stream{};
  constexpr int kGzip = 16;
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, MAX_WBITS + kGzip, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::runtime_error("deflateInit2");
  }
  std::string result(deflateBound(&stream, content.size()), '\0');
  std::string input = content;  // zlib wants no const
  stream.next_in = reinterpret_cast<Bytef*>(input.data());
  stream.avail_in = static_cast<uInt>(input.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  const int status = deflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  if (status != Z_STREAM_END) throw std::runtime_error("deflate");
  return result;
}

inline std::string xz(const std::string& content) {
  std::string result(lzma_stream_buffer_bound(content.size()), '\0');
  std::size_t size = 0;
  const lzma_ret status = lzma_easy_buffer_encode(LZMA_PRESET_DEFAULT, LZMA_CHECK_CRC64, nullptr,
                                                  reinterpret_cast<const std::uint8_t*>(content.data()), content.size(),
                                                  reinterpret_cast<std::uint8_t*>(result.data()), &size, result.size());
  if (status != LZMA_OK) throw std::runtime_error("lzma_easy_buffer_encode");
  result.resize(size);
  return result;
}

inline std::string zstd(const std::string& content) {
  std::string result(ZSTD_compressBound(content.size()), '\0');
  const std::size_t size =
      ZSTD_compress(result.data(), result.size(), content.data(), content.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(size) != 0) throw std::runtime_error(ZSTD_getErrorName(size));
  result.resize(size);
  return result;
}

/// `compression`: as ByteStream names it.
inline std::string compress(const std::string& content, const std::string& compression) {
  if (compression == "gzip") return gzip(content);
  if (compression == "xz") return xz(content);
  if (compression == "zstd") return zstd(content);
  return content;
}

}  // namespace sweepgrid::scene_files
