#pragma once

#include <utility>

#include "scenes/frame.hpp"
#include "scenes/scene_source.hpp"

namespace sweepgrid {

/// A recording made of whole frames: each step is the difference to the frame before.
class FrameSource : public SceneSource {
 public:
  bool next(SceneStep& step) final {
    frame_.clear();
    if (!read_frame(frame_)) return false;
    diff_frames(last_, frame_, step);
    std::swap(last_, frame_);
    return true;
  }

 protected:
  /// Appends the next frame's objects, sorted and distinct, to the empty `frame`; false at the end.
  virtual bool read_frame(Frame& frame) = 0;

 private:
  Frame last_;
  Frame frame_;
};

}  // namespace sweepgrid
