#include "scenes/byte_stream.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include <fmt/format.h>
#include <boost/iostreams/filter/gzip.hpp>
#include <boost/iostreams/filter/lzma.hpp>
#include <boost/iostreams/filter/zstd.hpp>

#include "scenes/scene_error.hpp"
#include "scenes/zstd_framing.hpp"

namespace sweepgrid {
namespace {

constexpr std::size_t kBufferSize = std::size_t{1} << 16;
constexpr std::size_t kLongestLine = std::size_t{1} << 20;

struct Magic {
  std::string_view bytes;
  std::string_view compression;
};
using namespace std::string_view_literals;
constexpr Magic kMagics[] = {{"\x1f\x8b"sv, "gzip"}, {"\xFD\x37zXZ\0"sv, "xz"}, {"\x28\xb5\x2f\xfd"sv, "zstd"}};

// Reads the first bytes and puts them back, which works for pipes as well.
std::string first_bytes(std::streambuf& file, std::size_t count) {
  std::string bytes;
  while (bytes.size() < count) {
    const int byte = file.sbumpc();
    if (byte == std::streambuf::traits_type::eof()) break;
    bytes.push_back(static_cast<char>(byte));
  }
  // A failed read at the end of the file leaves the buffer in place; the bytes are still in it.
  for (std::size_t i = 0; i < bytes.size(); ++i) file.sungetc();
  return bytes;
}

std::unique_ptr<std::streambuf> open_file(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw SceneError(fmt::format("{}: is a directory", path));
  auto file = std::make_unique<std::filebuf>();
  if (file->open(path, std::ios::in | std::ios::binary) == nullptr) {
    throw SceneError(fmt::format("{}: {}", path, std::strerror(errno)));
  }
  return file;
}

}  // namespace

ByteStream::ByteStream(const std::string& path) : ByteStream(open_file(path), path) {}

ByteStream::ByteStream(std::unique_ptr<std::streambuf> bytes, std::string path)
    : path_(std::move(path)), compression_("none"), bytes_(std::move(bytes)), buffer_(kBufferSize) {
  namespace io = boost::iostreams;
  const std::string start = first_bytes(*bytes_, 6);
  for (const Magic& magic : kMagics) {
    if (start.starts_with(magic.bytes)) compression_ = magic.compression;
  }
  if (compression_ == "gzip") content_.push(io::gzip_decompressor());
  if (compression_ == "xz") content_.push(io::lzma_decompressor());
  if (compression_ == "zstd") {
    content_.push(io::zstd_decompressor());
    content_.push(ZstdCutDetector());
  }
  content_.push(*bytes_);
}

bool ByteStream::fill() {
  if (at_end_) return false;
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size()) buffer_.resize(2 * buffer_.size());
  std::streamsize count = 0;
  try {
    count = content_.sgetn(buffer_.data() + end_, static_cast<std::streamsize>(buffer_.size() - end_));
  } catch (const std::exception& error) {
    if (compression_ == "none") throw SceneError(fmt::format("{}: {}", path_, error.what()));
    throw SceneError(fmt::format("{}: byte {} of the content: the {} data are damaged or cut off ({})", path_,
                                 offset_ + (end_ - begin_), compression_, error.what()));
  }
  if (count <= 0) {
    at_end_ = true;
    return false;
  }
  end_ += static_cast<std::size_t>(count);
  return true;
}

std::string_view ByteStream::peek(std::size_t count) {
  while (end_ - begin_ < count && fill()) {
  }
  return {buffer_.data() + begin_, std::min(count, end_ - begin_)};
}

std::size_t ByteStream::read(char* to, std::size_t count) {
  std::size_t taken = 0;
  while (taken < count) {
    if (begin_ == end_ && !fill()) break;
    const std::size_t part = std::min(count - taken, end_ - begin_);
    std::memcpy(to + taken, buffer_.data() + begin_, part);
    begin_ += part;
    taken += part;
    offset_ += part;
  }
  return taken;
}

bool ByteStream::read_line(std::string_view& line) {
  std::size_t searched = 0;
  while (true) {
    const char* from = buffer_.data() + begin_;
    const std::size_t unread = end_ - begin_;
    const void* found = unread > searched ? std::memchr(from + searched, '\n', unread - searched) : nullptr;
    if (found != nullptr) {
      const auto length = static_cast<std::size_t>(static_cast<const char*>(found) - from);
      line = {from, length};
      if (line.ends_with('\r')) line.remove_suffix(1);
      begin_ += length + 1;
      offset_ += length + 1;
      ++line_;
      return true;
    }
    searched = unread;
    if (unread > kLongestLine) {
      ++line_;
      fail_at_line(fmt::format("longer than {} bytes", kLongestLine));
    }
    if (fill()) continue;
    if (unread == 0) return false;
    ++line_;
    fail_at_line("the file ends inside this line");
  }
}

void ByteStream::fail_at_byte(std::uint64_t byte, std::string_view reason) const {
  throw SceneError(fmt::format("{}: byte {}: {}", path_, byte, reason));
}

void ByteStream::fail_at_line(std::string_view reason) const {
  throw SceneError(fmt::format("{}: line {}: {}", path_, line_, reason));
}

}  // namespace sweepgrid
