#include "cli/scene_census.hpp"

#include <cmath>
#include <vector>

#include "cli/overlap_oracle.hpp"
#include "scenes/rounded_step.hpp"
#include "scenes/scene_error.hpp"

namespace sweepgrid {
namespace {

double largest_width(const SceneBox& box) {
  double width = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) width = std::max(width, box.max[axis] - box.min[axis]);
  return width;
}

bool moved_far(const SceneBox& before, const SceneBox& after) {
  double squared = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double shift = (after.min[axis] + after.max[axis] - before.min[axis] - before.max[axis]) / 2;
    squared += shift * shift;
  }
  return std::sqrt(squared) > 0.01 * largest_width(after);
}

class Census {
 public:
  void take(const SceneStep& step, bool is_start) {
    const std::size_t lived_on = count_ - step.erased.size();
    count_ = lived_on + step.inserted.size();
    result_.objects.take(count_);
    for (const SceneKey key : step.erased) oracle_.erase(key);
    for (std::size_t i = 0; i < step.inserted.size(); ++i) {
      oracle_.insert(step.inserted[i], step.inserted_boxes[i]);
      see(step.inserted_boxes[i]);
    }
    std::size_t moved = 0;
    for (std::size_t i = 0; i < step.updated.size(); ++i) {
      const SceneBox& before = oracle_.box(step.updated[i]);
      const SceneBox& after = step.updated_boxes[i];
      if (before == after) continue;  // they differed before they were rounded
      ++moved;
      result_.far_moved += moved_far(before, after) ? 1 : 0;
      oracle_.update(step.updated[i], after);
      see(after);
    }
    if (is_start) {
      result_.started = true;
      result_.objects_first = count_;
      result_.pairs_first = oracle_.pairs().size();
      return;
    }
    ++result_.steps;
    result_.moved.take(moved);
    result_.inserted.take(step.inserted.size());
    result_.erased.take(step.erased.size());
    if (lived_on > 0) result_.moved_part.take(static_cast<double>(moved) / static_cast<double>(lived_on));
  }

  void fail(const SceneError& error) { result_.error = error.what(); }

  SceneCensus finish() {
    result_.objects_last = count_;
    result_.pairs_last = oracle_.pairs().size();
    return result_;
  }

 private:
  void see(const SceneBox& box) {
    result_.width.take(largest_width(box));
    if (!result_.extent) result_.extent = box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      result_.extent->min[axis] = std::min(result_.extent->min[axis], box.min[axis]);
      result_.extent->max[axis] = std::max(result_.extent->max[axis], box.max[axis]);
    }
  }

  OverlapOracle oracle_;
  std::size_t count_ = 0;
  SceneCensus result_;
};

}  // namespace

SceneCensus take_census(SceneSource& source, std::optional<std::uint64_t> steps, bool rounded) {
  Census census;
  SceneStep step;
  std::vector<Box<float, 3>> scratch;
  for (std::uint64_t index = 0; index <= steps.value_or(std::numeric_limits<std::uint64_t>::max() - 1); ++index) {
    try {
      if (!source.next(step)) break;
    } catch (const SceneError& error) {
      census.fail(error);
      break;
    }
    if (rounded) {
      round_boxes(step.inserted_boxes, scratch);
      round_boxes(step.updated_boxes, scratch);
    }
    census.take(step, index == 0);
  }
  return census.finish();
}

}  // namespace sweepgrid
