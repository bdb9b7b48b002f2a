// Bytes as an .aabbs recording: every one is refused by name, or read as a second, simple decoder reads it.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "finding.hpp"
#include "scene_check.hpp"

namespace sweepgrid::fuzz {
namespace {

constexpr std::size_t kHeader = 304;
constexpr std::size_t kBox = 32;

template <class Number>
Number number_at(const std::string& bytes, std::size_t at) {
  static_assert(std::endian::native == std::endian::little);
  Number number;
  std::memcpy(&number, bytes.data() + at, sizeof(number));
  return number;
}

SceneBox box_at(const std::string& bytes, std::size_t at) {
  SceneBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.min[axis] = number_at<float>(bytes, at + 4 * axis);
    box.max[axis] = number_at<float>(bytes, at + 16 + 4 * axis);
  }
  if (planted("bit")) box.max[0] = -box.max[0];
  return box;
}

/// Compares what was read with what the bytes say: all of it, or the frames before an error.
void compare(const std::string& bytes, const Reading& reading) {
  if (reading.frames.empty()) return;
  require(bytes.size() >= kHeader, "a header that is cut off is taken");
  const auto objects = static_cast<std::size_t>(number_at<std::int32_t>(bytes, 256));
  const auto frames = static_cast<std::size_t>(number_at<std::int32_t>(bytes, 260)) + 1;
  require(!reading.error.empty() || reading.frames.size() == frames, "another number of frames than the header has");
  require(!reading.error.empty() || bytes.size() == kHeader + objects * frames * kBox,
          "more or fewer bytes than the header tells are taken");
  require(bytes.size() >= kHeader + objects * reading.frames.size() * kBox, "more frames than there are bytes for");
  std::size_t at = kHeader;
  for (const auto& boxes : reading.frames) {
    require(boxes.size() == objects, "another number of objects than the header has");
    for (std::size_t object = 0; object < objects; ++object, at += kBox) {
      const auto found = boxes.find(object);
      require(found != boxes.end() && found->second == box_at(bytes, at), "a box is not that of the bytes");
    }
  }
}

}  // namespace
}  // namespace sweepgrid::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sweepgrid::fuzz;  // NOLINT(google-build-using-namespace)
  const std::string bytes(data, data + size);
  // Other formats are other targets.
  if (bytes.starts_with("ITEM:")) return 0;
  const Reading reading = read_all(bytes, "input.aabbs");
  if (reading.info.compression == "none") compare(bytes, reading);
  return 0;
}
