#include "tune/scene_facts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <sweepgrid/engine/object_speed.hpp>

#include "accuracy/extent_sweep.hpp"

namespace sweepgrid::tune {
namespace {

using accuracy::Extent;
using study::KnownStep;

/// The boxes of a window's objects, by number.
class Boxes {
 public:
  explicit Boxes(const Window& window) : boxes_(window.scene.objects), there_(window.scene.objects) {}

  /// `moved(object, before, after)` is called for every update.
  template <class Moved>
  void apply(const KnownStep& step, Moved&& moved) {
    for (const std::uint32_t object : step.erased) there_[object] = 0;
    for (std::size_t i = 0; i < step.inserted.size(); ++i) {
      there_[step.inserted[i]] = 1;
      boxes_[step.inserted[i]] = step.inserted_boxes[i];
    }
    for (std::size_t i = 0; i < step.updated.size(); ++i) {
      SceneBox& box = boxes_[step.updated[i]];
      moved(step.updated[i], box, step.updated_boxes[i]);
      box = step.updated_boxes[i];
    }
  }

  [[nodiscard]] bool there(std::size_t object) const { return there_[object] != 0; }
  /// Those that are there; along `axis`, if there is one, they are [0, 0].
  [[nodiscard]] std::vector<Extent> extents(std::size_t axis = 3) const {
    std::vector<Extent> result;
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      if (there_[i] == 0) continue;
      Extent& extent = result.emplace_back(Extent{boxes_[i], i});
      if (axis < 3) extent.box.min[axis] = extent.box.max[axis] = 0;
    }
    return result;
  }

 private:
  std::vector<SceneBox> boxes_;
  std::vector<char> there_;
};

double count_pairs(std::vector<Extent> extents) {
  double pairs = 0;
  accuracy::for_each_meeting(extents, [&](std::size_t, std::size_t) { ++pairs; });
  return pairs;
}

double displacement(const SceneBox& before, const SceneBox& after) {
  double most = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    most =
        std::max({most, std::fabs(after.min[axis] - before.min[axis]), std::fabs(after.max[axis] - before.max[axis])});
  }
  return most;
}

void see_box(const SceneBox& box, double width, SceneFacts& facts) {
  double edge = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    edge = std::max(edge, box.max[axis] - box.min[axis]);
    for (const double value : {box.min[axis], box.max[axis]}) {
      facts.farthest = std::max(facts.farthest, std::fabs(value) / width);
      facts.floats = facts.floats && static_cast<double>(static_cast<float>(value)) == value;
    }
  }
  facts.least_edge = std::min(facts.least_edge, edge);
  facts.most_edge = std::max(facts.most_edge, edge);
}

}  // namespace

SceneFacts find_facts(const SceneSample& sample) {
  SceneFacts facts;
  facts.least_edge = std::numeric_limits<double>::infinity();
  const double width = sample.width > 0 ? sample.width : 1;
  const auto windows = static_cast<double>(sample.windows.size());
  std::vector<double> displacements;
  for (const Window& window : sample.windows) {
    Boxes boxes(window);
    for (std::size_t k = 0; k < window.scene.steps.size(); ++k) {
      const KnownStep& step = window.scene.steps[k];
      boxes.apply(step, [&](std::uint32_t /*object*/, const SceneBox& before, const SceneBox& after) {
        if (k >= window.first_measured()) displacements.push_back(displacement(before, after) / width);
      });
      for (const SceneBox& box : step.inserted_boxes) see_box(box, width, facts);
      for (const SceneBox& box : step.updated_boxes) see_box(box, width, facts);
    }
    facts.objects += static_cast<double>(boxes.extents().size()) / windows;
    facts.pairs += count_pairs(boxes.extents()) / windows;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      facts.pairs_without[axis] += count_pairs(boxes.extents(axis)) / windows;
    }
  }
  facts.updates = static_cast<double>(displacements.size()) / static_cast<double>(sample.measured());
  if (!displacements.empty()) {
    const auto middle = displacements.begin() + static_cast<std::ptrdiff_t>(displacements.size() / 2);
    std::nth_element(displacements.begin(), middle, displacements.end());
    facts.displacement = *middle;
    facts.most_displacement = *std::max_element(middle, displacements.end());
  }
  return facts;
}

double updates_outside(const SceneSample& sample, double margin) {
  double outside = 0;
  for (const Window& window : sample.windows) {
    // Where each object's envelope was made: a box is outside once an end is farther than the margin from there.
    std::vector<SceneBox> made(window.scene.objects);
    for (std::size_t k = 0; k < window.scene.steps.size(); ++k) {
      const KnownStep& step = window.scene.steps[k];
      for (std::size_t i = 0; i < step.inserted.size(); ++i) made[step.inserted[i]] = step.inserted_boxes[i];
      for (std::size_t i = 0; i < step.updated.size(); ++i) {
        SceneBox& envelope = made[step.updated[i]];
        const SceneBox& box = step.updated_boxes[i];
        bool inside = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          inside = inside && box.min[axis] >= envelope.min[axis] - margin * sample.width &&
                   box.max[axis] <= envelope.max[axis] + margin * sample.width;
        }
        if (inside) continue;
        envelope = box;
        if (k >= window.first_measured()) ++outside;
      }
    }
  }
  return outside / static_cast<double>(sample.measured());
}

double mean_speed(const SceneSample& sample, int stride) {
  const double fade = ObjectSpeed::fade_of(stride);
  double sum = 0;
  double objects = 0;
  for (const Window& window : sample.windows) {
    Boxes boxes(window);
    std::vector<ObjectSpeed> speeds(window.scene.objects);
    for (std::size_t k = 0; k < window.scene.steps.size(); ++k) {
      const auto now = static_cast<std::uint32_t>(k);
      const KnownStep& step = window.scene.steps[k];
      for (const std::uint32_t object : step.inserted) speeds[object].appear(now);
      boxes.apply(step, [&](std::uint32_t object, const SceneBox& before, const SceneBox& after) {
        speeds[object].note(displacement(before, after), now, fade);
      });
      if (k < window.first_measured()) continue;
      for (std::size_t object = 0; object < speeds.size(); ++object) {
        if (!boxes.there(object)) continue;
        sum += speeds[object].at(now, fade);
        ++objects;
      }
    }
  }
  const double width = sample.width > 0 ? sample.width : 1;
  return objects > 0 ? sum / objects / width : 0;
}

}  // namespace sweepgrid::tune
