#include "study/accuracy/known_scene.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "scenes/open_scene.hpp"
#include "scenes/scene_error.hpp"

namespace sweepgrid::study {
namespace {

using accuracy::TruthKind;

bool finite(const SceneBox& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(box.min[axis]) || !std::isfinite(box.max[axis])) return false;
  }
  return box.valid();
}

double width_of(const std::vector<SceneBox>& boxes, int dim) {
  std::vector<double> widths;
  widths.reserve(boxes.size());
  for (const SceneBox& box : boxes) {
    double sum = 0;
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(dim); ++axis) sum += box.max[axis] - box.min[axis];
    widths.push_back(sum / dim);
  }
  const auto middle = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
  std::nth_element(widths.begin(), middle, widths.end());
  return *middle;
}

}  // namespace

KnownSceneBuilder::KnownSceneBuilder(const SceneInfo& info, const std::vector<TruthKind>& truths) {
  scene_.info = info;
  for (const TruthKind kind : truths) {
    truths_.push_back(make_truth(kind, info));
    scene_.truths.push_back({kind, {}});
  }
}

void KnownSceneBuilder::take(const SceneStep& step) {
  check(step.inserted, step.inserted_boxes);
  check(step.updated, step.updated_boxes);
  if (scene_.steps.empty()) {
    if (step.inserted.empty()) throw SceneError(fmt::format("{}: there are no objects at the start", scene_.info.name));
    scene_.width = width_of(step.inserted_boxes, scene_.info.dim);
  }
  for (std::size_t i = 0; i < truths_.size(); ++i) scene_.truths[i].pairs.push_back(truths_[i]->step(step));
  scene_.steps.push_back({numbering_.numbers(step.erased), numbering_.numbers(step.inserted), step.inserted,
                          step.inserted_boxes, numbering_.numbers(step.updated), step.updated_boxes});
}

KnownScene KnownSceneBuilder::finish() {
  scene_.objects = numbering_.size();
  if (scene_.steps.size() < 2) throw SceneError(fmt::format("{}: there is no step after the start", scene_.info.name));
  return std::move(scene_);
}

// Bad input has no truth, and integers know no infinity.
void KnownSceneBuilder::check(const std::vector<SceneKey>& keys, const std::vector<SceneBox>& boxes) {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!finite(boxes[i])) {
      throw SceneError(fmt::format("{}: step {}: the box of object {} is not finite, or has min > max",
                                   scene_.info.name, scene_.steps.size(), keys[i]));
    }
    if (std::exchange(empty_, false)) scene_.world = boxes[i];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      scene_.world.min[axis] = std::min(scene_.world.min[axis], boxes[i].min[axis]);
      scene_.world.max[axis] = std::max(scene_.world.max[axis], boxes[i].max[axis]);
    }
  }
}

KnownScene know_scene(const std::string& name, std::uint64_t steps) {
  const std::unique_ptr<SceneSource> source = open_scene(name);
  SceneInfo info = source->info();
  info.name = name;
  std::vector<TruthKind> truths = {TruthKind::kInstants, TruthKind::kMotion};
  if (info.shapes != ShapeKind::kBoxes) truths.push_back(TruthKind::kShapes);
  KnownSceneBuilder builder(info, truths);
  SceneStep step;
  for (std::uint64_t k = 0; k <= steps && source->next(step); ++k) builder.take(step);
  return builder.finish();
}

}  // namespace sweepgrid::study
