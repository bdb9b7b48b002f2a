#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <sweepgrid/engine/events.hpp>

#include "cli/output_file.hpp"
#include "scenes/scene_source.hpp"

namespace sweepgrid {

/// The events of a run as text: a header line, then "step,begin,a,b" or "step,end,a,b" per event, in the engine's
/// order, the ends of a step first. Step 0 is the start. With several scenes the first column is the scene's number,
/// from 1.
class EventsFile {
 public:
  EventsFile(std::string path, std::size_t scene_count);

  void begin_scene() { ++scene_; }
  void write(std::uint64_t step, const Events<SceneKey>& events);
  void commit();

 private:
  OutputFile file_;
  bool with_scene_;
  std::size_t scene_ = 0;
};

}  // namespace sweepgrid
