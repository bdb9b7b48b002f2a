#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "finding.hpp"
#include "scenes/open_scene.hpp"
#include "scenes/scene_error.hpp"
#include "scenes/scene_source.hpp"

/// What holds of every scene, and reading one from bytes.
namespace sweepgrid::fuzz {

/// What came of reading a scene: its steps, and why it ended if that was an error.
struct Reading {
  SceneInfo info;
  std::vector<std::map<SceneKey, SceneBox>> frames;  ///< all objects after each step
  std::string error;
};

/// Takes a scene's steps and holds them to SceneStep's contract.
class SceneCheck {
 public:
  /// `bad_boxes`: boxes may be invalid, as those of generators that make bad input.
  explicit SceneCheck(bool bad_boxes = false) : bad_boxes_(bad_boxes) {}

  void take(const SceneStep& step) {
    require(step.inserted.size() == step.inserted_boxes.size(), "another number of boxes than of inserted objects");
    require(step.updated.size() == step.updated_boxes.size(), "another number of boxes than of updated objects");
    const bool shapes = !step.inserted_shapes.empty() || !step.updated_shapes.empty();
    require(!shapes || step.inserted_shapes.size() == step.inserted.size(), "another number of shapes than of inserts");
    require(!shapes || step.updated_shapes.size() == step.updated.size(), "another number of shapes than of updates");
    std::set<SceneKey> seen;
    const auto once = [&](SceneKey key) { require(seen.insert(key).second, "a key twice in a step"); };
    for (const SceneKey key : step.erased) {
      once(key);
      require(boxes_.erase(key) == 1, "an erase of an object that is not there");
    }
    for (std::size_t i = 0; i < step.updated.size(); ++i) {
      once(step.updated[i]);
      const auto object = boxes_.find(step.updated[i]);
      require(object != boxes_.end(), "an update of an object that is not there");
      require(bad_boxes_ || step.updated_boxes[i].valid(), "an update with a bad box");
      require(bad_boxes_ || !(object->second == step.updated_boxes[i]), "an update to the same box");
      object->second = step.updated_boxes[i];
    }
    for (std::size_t i = 0; i < step.inserted.size(); ++i) {
      once(step.inserted[i]);
      require(bad_boxes_ || step.inserted_boxes[i].valid(), "an insert with a bad box");
      require(boxes_.emplace(step.inserted[i], step.inserted_boxes[i]).second, "an insert of an object that is there");
    }
  }

  [[nodiscard]] const std::map<SceneKey, SceneBox>& boxes() const { return boxes_; }

 private:
  bool bad_boxes_;
  std::map<SceneKey, SceneBox> boxes_;
};

/// Reads bytes to the end, or to an error.
inline Reading read_all(const std::string& bytes, const std::string& name, const SceneOptions& options = {}) {
  constexpr std::size_t kMostFrames = 70'000;  // more than readers believe without bytes for them
  Reading reading;
  try {
    const auto source = open_recording(std::make_unique<std::stringbuf>(bytes), name, options);
    reading.info = source->info();
    SceneCheck check;
    SceneStep step;
    while (source->next(step)) {
      check.take(step);
      reading.frames.push_back(check.boxes());
      require(reading.frames.size() <= kMostFrames, "a scene of few bytes does not end");
    }
    require(!reading.frames.empty(), "a scene without a start");
    require(!reading.info.steps || *reading.info.steps + 1 == reading.frames.size(),
            "another number of frames than told");
  } catch (const SceneError& error) {
    reading.error = error.what();
    require(reading.error.starts_with(name + ": "), "an error that does not name the file: " + reading.error);
  }
  return reading;
}

}  // namespace sweepgrid::fuzz
