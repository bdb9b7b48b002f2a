#include "scenes/byte_stream.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "scenes/scene_error.hpp"

namespace sweepgrid {
namespace {

constexpr std::size_t kBufferSize = std::size_t{1} << 16;
constexpr std::size_t kLongestLine = std::size_t{1} << 20;

std::unique_ptr<std::streambuf> open_file(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw SceneError(fmt::format("{}: is a directory", path));
  auto file = std::make_unique<std::filebuf>();
  if (file->open(path, std::ios::in | std::ios::binary) == nullptr) {
    throw SceneError(fmt::format("{}: {}", path, std::strerror(errno)));
  }
  return file;
}

// From where `bytes` stands to its end; nothing for pipes and devices.
std::optional<std::uint64_t> size_of(std::streambuf& bytes) {
  const std::streamoff here = bytes.pubseekoff(0, std::ios::cur, std::ios::in);
  if (here < 0) return std::nullopt;
  const std::streamoff end = bytes.pubseekoff(0, std::ios::end, std::ios::in);
  if (bytes.pubseekpos(here, std::ios::in) != std::streampos(here)) return std::nullopt;
  if (end <= here) return std::nullopt;  // a device says 0
  return static_cast<std::uint64_t>(end - here);
}

}  // namespace

ByteStream::ByteStream(const std::string& path) : ByteStream(open_file(path), path) {}

ByteStream::ByteStream(std::unique_ptr<std::streambuf> bytes, std::string path)
    : path_(std::move(path)), bytes_(std::move(bytes)), buffer_(kBufferSize) {
  const std::optional<std::uint64_t> size = size_of(*bytes_);
  // Unpacked until it is known what they are.
  compression_ = compression_of(peek(kLongestMagic));
  decompressor_ = make_decompressor(compression_);
  if (decompressor_ == nullptr) {
    size_ = size;
    return;
  }
  packed_.swap(buffer_);
  std::swap(packed_begin_, begin_);
  std::swap(packed_end_, end_);
  bytes_ended_ = std::exchange(at_end_, false);
  buffer_.resize(kBufferSize);
}

std::size_t ByteStream::bytes(std::span<char> to) {
  try {
    // Takes what is there and does not wait for more: a pipe may be slow.
    if (bytes_->sgetc() == std::streambuf::traits_type::eof()) return 0;
    const auto ready = std::max<std::streamsize>(bytes_->in_avail(), 1);
    const auto count = std::min(ready, static_cast<std::streamsize>(to.size()));
    return static_cast<std::size_t>(std::max<std::streamsize>(bytes_->sgetn(to.data(), count), 0));
  } catch (const std::ios_base::failure& error) {
    damage_ = error.what();
    return 0;
  }
}

std::size_t ByteStream::content(std::span<char> to) {
  if (decompressor_ == nullptr) return bytes(to);
  while (true) {
    if (packed_begin_ == packed_end_ && !bytes_ended_) {
      packed_begin_ = 0;
      packed_end_ = bytes(packed_);
      bytes_ended_ = packed_end_ == 0;
    }
    const std::string_view in(packed_.data() + packed_begin_, packed_end_ - packed_begin_);
    const Decompressor::Progress progress = decompressor_->run(in, to, bytes_ended_);
    packed_begin_ += progress.taken;
    if (progress.given > 0) return progress.given;
    if (!bytes_ended_ || progress.taken > 0) continue;
    if (damage_.empty() && !decompressor_->complete()) damage_ = fmt::format("the {} data are cut off", compression_);
    return 0;
  }
}

bool ByteStream::fill() {
  if (at_end_) return false;
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size()) buffer_.resize(2 * buffer_.size());
  std::size_t count = 0;
  try {
    count = content(std::span(buffer_).subspan(end_));
  } catch (const std::runtime_error& error) {
    damage_ = fmt::format("the {} data are damaged ({})", compression_, error.what());
  }
  at_end_ = count == 0;
  end_ += count;
  return !at_end_;
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
    fail_at_end_in_lines("inside this line");
  }
}

void ByteStream::fail_at_byte(std::uint64_t byte, std::string_view reason) const {
  throw SceneError(fmt::format("{}: byte {}: {}", path_, byte, reason));
}

void ByteStream::fail_at_line(std::string_view reason) const {
  throw SceneError(fmt::format("{}: line {}: {}", path_, line_, reason));
}

void ByteStream::fail_at_end_in_bytes(std::string_view where) const { fail_at_byte(offset_, end_reason(where)); }

void ByteStream::fail_at_end_in_lines(std::string_view where) const { fail_at_line(end_reason(where)); }

std::string ByteStream::end_reason(std::string_view where) const {
  return fmt::format("the file ends {}{}{}", where, damage_.empty() ? "" : ": ", damage_);
}

}  // namespace sweepgrid
