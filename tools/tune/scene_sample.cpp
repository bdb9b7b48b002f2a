#include "tune/scene_sample.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "scenes/scene_error.hpp"

namespace sweepgrid::tune {
namespace {

/// What is there, so that a window can start anywhere.
class LiveObjects {
 public:
  void apply(const SceneStep& step) {
    for (const SceneKey key : step.erased) objects_.erase(key);
    put(step.inserted, step.inserted_boxes, step.inserted_shapes);
    put(step.updated, step.updated_boxes, step.updated_shapes);
  }

  [[nodiscard]] SceneStep start() const {
    SceneStep step;
    for (const auto& [key, object] : objects_) {
      step.inserted.push_back(key);
      step.inserted_boxes.push_back(object.box);
      if (object.shape) step.inserted_shapes.push_back(*object.shape);
    }
    return step;
  }

 private:
  struct Object {
    SceneBox box;
    std::optional<OrientedBox> shape;
  };

  void put(const std::vector<SceneKey>& keys, const std::vector<SceneBox>& boxes,
           const std::vector<OrientedBox>& shapes) {
    for (std::size_t i = 0; i < keys.size(); ++i) {
      Object& object = objects_[keys[i]];
      object.box = boxes[i];
      if (!shapes.empty()) object.shape = shapes[i];
    }
  }

  std::map<SceneKey, Object> objects_;
};

std::uint64_t count_steps(const SceneText& text) {
  const std::unique_ptr<SceneSource> source = open_scene(text.name, text.options);
  const std::uint64_t limit = text.steps.value_or(std::numeric_limits<std::uint64_t>::max());
  if (const auto told = source->info().steps) return std::min(*told, limit);
  SceneStep step;
  std::uint64_t steps = 0;
  if (!source->next(step)) return 0;
  while (steps < limit && source->next(step)) ++steps;
  return steps;
}

SceneBox hull(SceneBox box, const SceneBox& other) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.min[axis] = std::min(box.min[axis], other.min[axis]);
    box.max[axis] = std::max(box.max[axis], other.max[axis]);
  }
  return box;
}

SceneSample read_windows(const SceneText& text, accuracy::TruthKind truth, std::uint64_t steps,
                         const std::vector<WindowPlan>& plans) {
  const std::unique_ptr<SceneSource> source = open_scene(text.name, text.options);
  SceneSample sample;
  sample.info = source->info();
  sample.steps = steps;
  LiveObjects live;
  SceneStep step;
  std::uint64_t read = 0;  // steps, with the start
  for (const WindowPlan& plan : plans) {
    for (; read <= plan.begin && source->next(step); ++read) live.apply(step);
    study::KnownSceneBuilder builder(sample.info, {truth});
    builder.take(live.start());
    const std::uint64_t last = plan.begin + plan.warm_up + plan.measured;
    for (; read <= last && source->next(step); ++read) {
      builder.take(step);
      live.apply(step);
    }
    sample.windows.push_back({plan.begin, plan.warm_up, builder.finish()});
    const study::KnownScene& scene = sample.windows.back().scene;
    sample.world = sample.windows.size() == 1 ? scene.world : hull(sample.world, scene.world);
  }
  sample.width = sample.windows.front().scene.width;
  return sample;
}

std::uint64_t some_steps(const SceneText& text) {
  const std::uint64_t steps = count_steps(text);
  if (steps == 0) throw SceneError(fmt::format("{}: there is no step after the start", text.name));
  return steps;
}

}  // namespace

std::size_t SceneSample::measured() const {
  std::size_t sum = 0;
  for (const Window& window : windows) sum += window.measured();
  return sum;
}

std::vector<WindowPlan> plan_windows(std::uint64_t steps) {
  constexpr std::uint64_t kHalf = 8;
  constexpr std::uint64_t kSpread = 64;  // steps from which on a second window tells something else
  if (steps < 2 * kHalf) return {{0, static_cast<std::size_t>(steps / 2), static_cast<std::size_t>(steps - steps / 2)}};
  const std::uint64_t count = steps < kSpread ? 1 : 2;
  std::vector<WindowPlan> plans;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t middle = steps * (2 * i + 1) / (2 * count);
    plans.push_back({middle - std::min(middle, kHalf), kHalf, kHalf});
  }
  return plans;
}

SceneSample take_sample(const SceneText& text, accuracy::TruthKind truth) {
  const std::uint64_t steps = some_steps(text);
  return read_windows(text, truth, steps, plan_windows(steps));
}

SceneSample take_whole(const SceneText& text, accuracy::TruthKind truth) {
  const std::uint64_t steps = some_steps(text);
  return read_windows(text, truth, steps, {{0, 0, static_cast<std::size_t>(steps)}});
}

}  // namespace sweepgrid::tune
