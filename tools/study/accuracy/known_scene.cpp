#include "study/accuracy/known_scene.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "scenes/open_scene.hpp"
#include "scenes/scene_error.hpp"
#include "scenes/scene_numbering.hpp"

namespace sweepgrid::study {
namespace {

using accuracy::TruthKind;

bool finite(const SceneBox& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(box.min[axis]) || !std::isfinite(box.max[axis])) return false;
  }
  return box.valid();
}

class Reader {
 public:
  explicit Reader(const std::string& name) : source_(open_scene(name)) {
    scene_.name = name;
    const SceneInfo& info = source_->info();
    std::vector<TruthKind> kinds = {TruthKind::kInstants, TruthKind::kMotion};
    if (info.shapes != ShapeKind::kBoxes) kinds.push_back(TruthKind::kShapes);
    for (const TruthKind kind : kinds) {
      truths_.push_back(make_truth(kind, info));
      scene_.truths.push_back({kind, {}});
    }
  }

  KnownScene read(std::uint64_t steps) {
    SceneStep ops;
    for (std::uint64_t k = 0; k <= steps && source_->next(ops); ++k) {
      check(ops.inserted, ops.inserted_boxes, k);
      check(ops.updated, ops.updated_boxes, k);
      if (k == 0) scene_.width = width_of(ops.inserted_boxes);
      for (std::size_t i = 0; i < truths_.size(); ++i) scene_.truths[i].pairs.push_back(truths_[i]->step(ops));
      scene_.steps.push_back({numbering_.numbers(ops.erased), numbering_.numbers(ops.inserted), ops.inserted,
                              ops.inserted_boxes, numbering_.numbers(ops.updated), ops.updated_boxes});
    }
    scene_.objects = numbering_.size();
    if (scene_.steps.size() < 2) throw SceneError(fmt::format("{}: there is no step after the start", scene_.name));
    return std::move(scene_);
  }

 private:
  // Bad input has no truth, and integers know no infinity.
  void check(const std::vector<SceneKey>& keys, const std::vector<SceneBox>& boxes, std::uint64_t step) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (!finite(boxes[i])) {
        throw SceneError(fmt::format("{}: step {}: the box of object {} is not finite, or has min > max", scene_.name,
                                     step, keys[i]));
      }
      if (std::exchange(empty_, false)) scene_.world = boxes[i];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        scene_.world.min[axis] = std::min(scene_.world.min[axis], boxes[i].min[axis]);
        scene_.world.max[axis] = std::max(scene_.world.max[axis], boxes[i].max[axis]);
      }
    }
  }

  [[nodiscard]] double width_of(const std::vector<SceneBox>& boxes) const {
    if (boxes.empty()) throw SceneError(fmt::format("{}: there are no objects at the start", scene_.name));
    std::vector<double> widths;
    widths.reserve(boxes.size());
    const auto dim = static_cast<std::size_t>(source_->info().dim);
    for (const SceneBox& box : boxes) {
      double sum = 0;
      for (std::size_t axis = 0; axis < dim; ++axis) sum += box.max[axis] - box.min[axis];
      widths.push_back(sum / static_cast<double>(dim));
    }
    const auto middle = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
    std::nth_element(widths.begin(), middle, widths.end());
    return *middle;
  }

  std::unique_ptr<SceneSource> source_;
  std::vector<std::unique_ptr<accuracy::Truth>> truths_;
  SceneNumbering numbering_;
  bool empty_ = true;  // no box has been seen
  KnownScene scene_;
};

}  // namespace

KnownScene know_scene(const std::string& name, std::uint64_t steps) { return Reader(name).read(steps); }

}  // namespace sweepgrid::study
