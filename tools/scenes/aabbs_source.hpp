#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "scenes/byte_stream.hpp"
#include "scenes/frame_source.hpp"

namespace sweepgrid {

/// Reads Broadmark's `.aabbs`: float32 boxes of a fixed number of objects. Object k is the k-th box of every frame.
class AabbsSource : public FrameSource {
 public:
  /// Bytes of the header.
  static constexpr std::size_t kHeaderSize = 304;

  explicit AabbsSource(std::unique_ptr<ByteStream> content);

  /// Whether a file that starts so can be one. The format has no magic bytes: the names must be text filled up with
  /// NULs, the counts not negative, and the world a valid box.
  [[nodiscard]] static bool recognises(std::string_view start);

  [[nodiscard]] const SceneInfo& info() const override { return info_; }

 protected:
  bool read_frame(Frame& frame) override;

 private:
  // Whether the counts make sense together, and beside the size of the file where that is known.
  void check_size() const;

  std::unique_ptr<ByteStream> content_;
  SceneInfo info_;
  std::uint64_t object_count_ = 0;
  std::uint64_t frame_count_ = 0;
  std::uint64_t frames_read_ = 0;
};

}  // namespace sweepgrid
