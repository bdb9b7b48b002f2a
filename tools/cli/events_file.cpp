#include "cli/events_file.hpp"

#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace sweepgrid {

EventsFile::EventsFile(std::string path, std::size_t scene_count)
    : file_(std::move(path)), with_scene_(scene_count > 1) {
  file_.write(with_scene_ ? "scene,step,event,a,b\n" : "step,event,a,b\n");
}

void EventsFile::write(std::uint64_t step, const Events<SceneKey>& events) {
  fmt::memory_buffer text;
  const auto append = [&](std::string_view event, const std::vector<Pair<SceneKey>>& pairs) {
    for (const Pair<SceneKey>& pair : pairs) {
      if (with_scene_) fmt::format_to(std::back_inserter(text), "{},", scene_);
      fmt::format_to(std::back_inserter(text), "{},{},{},{}\n", step, event, pair.first, pair.second);
    }
  };
  append("end", events.ends);
  append("begin", events.begins);
  file_.write({text.data(), text.size()});
}

void EventsFile::commit() { file_.commit(); }

}  // namespace sweepgrid
