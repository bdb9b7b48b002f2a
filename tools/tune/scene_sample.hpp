#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "accuracy/truth.hpp"
#include "scenes/open_scene.hpp"
#include "study/accuracy/known_scene.hpp"

namespace sweepgrid::tune {

/// Steps of a scene in a row, as a scene of its own: the first step inserts what is there when the window begins.
struct Window {
  std::uint64_t begin = 0;  ///< the scene's step that it starts with, 0 being the scene's start
  std::size_t warm_up = 0;  ///< steps after that which are played for what they leave behind, and not measured
  study::KnownScene scene;  ///< with one truth

  [[nodiscard]] std::size_t first_measured() const { return 1 + warm_up; }
  [[nodiscard]] std::size_t measured() const { return scene.steps.size() - first_measured(); }
};

/// Where windows lie.
struct WindowPlan {
  std::uint64_t begin = 0;
  std::size_t warm_up = 0;
  std::size_t measured = 0;
};

/// Windows for a scene of so many steps after the start, at least 1: up to two, of 16 steps each, the first half of
/// them to warm up; evenly spread.
[[nodiscard]] std::vector<WindowPlan> plan_windows(std::uint64_t steps);

/// A few windows of a scene, or the whole as one window.
struct SceneSample {
  SceneInfo info;
  std::uint64_t steps = 0;  ///< of the scene, after the start
  std::vector<Window> windows;
  double width = 0;  ///< the median of the mean edges of the objects of the first window
  SceneBox world;    ///< holds every box of the windows

  [[nodiscard]] std::size_t measured() const;
};

/// What is to be read.
struct SceneText {
  std::string name;  ///< as open_scene() takes it
  SceneOptions options;
  std::optional<std::uint64_t> steps;  ///< at most so many after the start
};

/// Reads windows, passing over what lies between them. Throws what open_scene() throws, and SceneError for a scene
/// without steps, and for boxes that are bad input or infinite.
[[nodiscard]] SceneSample take_sample(const SceneText& text, accuracy::TruthKind truth);

/// Likewise one window of everything.
[[nodiscard]] SceneSample take_whole(const SceneText& text, accuracy::TruthKind truth);

}  // namespace sweepgrid::tune
