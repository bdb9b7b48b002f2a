#include "scenes/aabbs_source.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include <fmt/format.h>

namespace sweepgrid {
namespace {

constexpr std::size_t kNameSize = 128;
constexpr std::size_t kCountsAt = 2 * kNameSize;
constexpr std::size_t kWorldAt = 272;
constexpr std::size_t kBoxSize = 32;
constexpr std::size_t kBoxesAtOnce = 4096;
// Frames without boxes have no bytes that would bear their number out, so that a damaged header can tell any.
constexpr std::uint64_t kMostEmptyFrames = 1 << 16;

std::uint32_t read_u32(const char* from) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(from[i]);
  return value;
}

std::int32_t read_i32(const char* from) { return std::bit_cast<std::int32_t>(read_u32(from)); }

// min[3], padding, max[3], padding
SceneBox read_box(const char* from) {
  SceneBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.min[axis] = std::bit_cast<float>(read_u32(from + 4 * axis));
    box.max[axis] = std::bit_cast<float>(read_u32(from + 16 + 4 * axis));
  }
  return box;
}

// Text up to the first NUL, with what is not printable replaced.
std::string read_name(const char* from) {
  std::string name(from, std::find(from, from + kNameSize, '\0'));
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return name;
}

// Printable, ended by a NUL and filled up with more of them.
bool is_name(std::string_view field) {
  const auto end = std::find(field.begin(), field.end(), '\0');
  return end != field.end() && std::all_of(field.begin(), end, [](char c) { return c >= ' ' && c <= '~'; }) &&
         std::all_of(end, field.end(), [](char c) { return c == '\0'; });
}

}  // namespace

bool AabbsSource::recognises(std::string_view start) {
  return start.size() >= kHeaderSize && is_name(start.substr(0, kNameSize)) &&
         is_name(start.substr(kNameSize, kNameSize)) && read_i32(start.data() + kCountsAt) >= 0 &&
         read_i32(start.data() + kCountsAt + 4) >= 0 && read_box(start.data() + kWorldAt).valid();
}

AabbsSource::AabbsSource(std::unique_ptr<ByteStream> content) : content_(std::move(content)) {
  std::array<char, kHeaderSize> header;
  if (content_->read(header.data(), header.size()) < header.size()) {
    content_->fail_at_end_in_bytes(fmt::format("inside the {} bytes of the .aabbs header", kHeaderSize));
  }
  const std::int32_t objects = read_i32(header.data() + kCountsAt);
  const std::int32_t steps = read_i32(header.data() + kCountsAt + 4);
  const SceneBox world = read_box(header.data() + kWorldAt);
  if (objects < 0) content_->fail_at_byte(kCountsAt, fmt::format("the .aabbs header tells {} objects", objects));
  if (steps < 0) content_->fail_at_byte(kCountsAt + 4, fmt::format("the .aabbs header tells {} steps", steps));
  if (!world.valid()) content_->fail_at_byte(kWorldAt, "the world box of the .aabbs header has a NaN or min > max");
  object_count_ = static_cast<std::uint64_t>(objects);
  frame_count_ = static_cast<std::uint64_t>(steps) + 1;
  info_.name = content_->path();
  info_.format = "aabbs";
  info_.compression = content_->compression();
  info_.bounds = world;
  info_.steps = frame_count_ - 1;
  info_.details = {{"scene", read_name(header.data())}, {"objects type", read_name(header.data() + kNameSize)}};
  check_size();
}

void AabbsSource::check_size() const {
  if (object_count_ == 0 && frame_count_ > kMostEmptyFrames) {
    content_->fail_at_byte(kCountsAt + 4,
                           fmt::format("the .aabbs header tells {} frames without objects", frame_count_));
  }
  const std::uint64_t boxes = object_count_ * frame_count_;  // each below 2^32
  if (boxes > (std::numeric_limits<std::uint64_t>::max() - kHeaderSize) / kBoxSize) {
    content_->fail_at_byte(
        kCountsAt, fmt::format("the .aabbs header tells {} frames of {} objects, too many for a file", frame_count_,
                               object_count_));
  }
  if (!content_->size()) return;
  const std::uint64_t told = kHeaderSize + kBoxSize * boxes;
  const std::uint64_t found = *content_->size();
  // A file that is cut in a later frame is read up to there.
  if (found == told || (found < told && found >= kHeaderSize + kBoxSize * object_count_)) return;
  content_->fail_at_byte(
      std::min(found, told),
      fmt::format("the header tells {} frames of {} objects, which are {} bytes, but the file has {}", frame_count_,
                  object_count_, told, found));
}

bool AabbsSource::read_frame(Frame& frame) {
  if (frames_read_ == frame_count_) {
    // Looking for more also makes the decompressor check the end of its stream.
    if (!content_->peek(1).empty()) {
      content_->fail_at_byte(content_->offset(),
                             fmt::format("more data behind the {} frames that the header tells", frame_count_));
    }
    if (!content_->damage().empty()) content_->fail_at_end_in_bytes(fmt::format("behind frame {}", frame_count_));
    return false;
  }
  // In parts, so that a wrong count in the header runs into the end of the file and not out of memory.
  std::vector<char> part(kBoxSize * std::min<std::size_t>(kBoxesAtOnce, object_count_));
  for (std::uint64_t first = 0; first < object_count_; first += kBoxesAtOnce) {
    const std::size_t count = std::min<std::uint64_t>(kBoxesAtOnce, object_count_ - first);
    const std::uint64_t at = content_->offset();
    const std::size_t size = content_->read(part.data(), kBoxSize * count);
    if (size < kBoxSize * count) {
      content_->fail_at_end_in_bytes(
          fmt::format("inside frame {} of {}, at object {}", frames_read_ + 1, frame_count_, first + size / kBoxSize));
    }
    for (std::size_t i = 0; i < count; ++i) {
      const SceneBox box = read_box(part.data() + kBoxSize * i);
      if (!box.valid()) {
        content_->fail_at_byte(at + kBoxSize * i, fmt::format("the box of object {} in frame {} has a NaN or min > max",
                                                              first + i, frames_read_ + 1));
      }
      frame.keys.push_back(first + i);
      frame.boxes.push_back(box);
    }
  }
  ++frames_read_;
  return true;
}

}  // namespace sweepgrid
