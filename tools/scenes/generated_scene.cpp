#include "scenes/generated_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace sweepgrid {
namespace {

// By Newton's method, because std::cbrt differs between machines in the last bit.
double cube_root(double value) {
  double root = std::max(value, 1.0);
  while (true) {
    const double next = root - (root - value / (root * root)) / 3;
    if (!(next < root)) return root;  // falls until it is exact to rounding
    root = next;
  }
}

// How many of `count` things are a `part` of them, when they are taken one after another: the parts of all prefixes
// are right as well.
std::uint64_t quota(double part, std::uint64_t index) {
  const auto upto = [part](std::uint64_t count) { return std::floor(part * static_cast<double>(count) + 0.5); };
  return static_cast<std::uint64_t>(upto(index + 1) - upto(index));
}

}  // namespace

GeneratedScene::GeneratedScene(std::string name, const GeneratorParams& params)
    : params_(params),
      random_(params.seed),
      dim_(params.dim),
      axis_(std::min(params.axis, params.dim - 1)),
      offset_(params.offset * params.width),
      slots_(params.n) {
  const std::uint64_t covers = std::min(params_.covers, params_.n);
  moving_count_ = static_cast<std::size_t>(std::floor(params_.moving * static_cast<double>(params_.n) + 0.5));
  moving_count_ = std::min<std::size_t>(moving_count_, params_.n - covers);
  int side = 1;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    slots_[i].width = quota(params_.large, i) > 0 ? params_.width * params_.scale : params_.width;
    slots_[i].covers = i >= slots_.size() - covers;
    if (quota(params_.infinite, i) > 0) slots_[i].reaches = side, side = -side;
  }
  deck_.resize(slots_.size());
  std::iota(deck_.begin(), deck_.end(), 0U);
  lay_out_world();
  for (std::uint64_t i = 0; i < params_.clusters; ++i) {
    Vector& centre = clump_centres_.emplace_back();
    for (std::size_t axis = 0; axis < dim_; ++axis) centre[axis] = random_.between(0, world_[axis]);
  }
  if (params_.turn > 0) {
    for (std::size_t i = 0; i < slots_.size(); ++i) spins_.emplace_back(random_, dim_);
  }
  info_.name = std::move(name);
  info_.format = "generator";
  info_.compression = "none";
  info_.dim = static_cast<int>(dim_);
  info_.shapes = spins_.empty() ? ShapeKind::kBoxes : ShapeKind::kOrientedBoxes;
  info_.bounds = SceneBox({0, 0, 0}, world_);
  for (std::size_t axis = 0; axis < dim_; ++axis) {
    info_.bounds->min[axis] += offset_;
    info_.bounds->max[axis] += offset_;
  }
  info_.steps = params_.steps;
  info_.details = describe(params_);
}

void GeneratedScene::lay_out_world() {
  double volume = 0;
  double widest = 0;
  for (const Slot& slot : slots_) {
    volume += dim_ == 3 ? slot.width * slot.width * slot.width : slot.width * slot.width;
    widest = std::max(widest, slot.width);
  }
  volume /= params_.density;
  const double height = std::max(params_.layers * params_.width, widest);
  const bool flat = params_.layers > 0;
  if (flat) volume /= height;
  const std::size_t other_axes = flat ? dim_ - 1 : dim_;
  const double edge = other_axes == 3 ? cube_root(volume) : other_axes == 2 ? std::sqrt(volume) : volume;
  for (std::size_t axis = 0; axis < dim_; ++axis) {
    world_[axis] = flat && axis == axis_ ? height : std::max(edge, widest);
  }
}

bool GeneratedScene::next(SceneStep& step) {
  step.clear();
  if (!started_) {
    started_ = true;
    start(step);
    return true;
  }
  if (step_ == params_.steps) return false;
  ++step_;
  replace_some(step);
  move(step);
  shake(step);
  return true;
}

void GeneratedScene::start(SceneStep& step) {
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    Slot& slot = slots_[i];
    if (i < moving_count_) {
      slot.velocity = random_direction();
      for (double& component : slot.velocity) component *= params_.speed * params_.width;
    }
    fill(slot);
    tell_insert(slot, step);
  }
}

void GeneratedScene::replace_some(SceneStep& step) {
  const std::uint64_t count =
      std::min<std::uint64_t>(quota(params_.churn * static_cast<double>(params_.n), step_ - 1), params_.n);
  for (std::uint64_t i = 0; i < count; ++i) {
    // A shuffle stopped early: the first `count` of the deck are distinct slots at random.
    std::swap(deck_[i], deck_[i + random_.below(deck_.size() - i)]);
    Slot& slot = slots_[deck_[i]];
    step.erased.push_back(slot.key);
    fill(slot);
    tell_insert(slot, step);
  }
}

void GeneratedScene::move(SceneStep& step) {
  for (std::size_t i = 0; i < moving_count_; ++i) {
    Slot& slot = slots_[i];
    if (slot.filled_in_step == step_) continue;
    const SceneBox before = box(slot);
    if (params_.teleport > 0 && random_.unit() < params_.teleport) {
      place(slot);
    } else if (params_.cross > 0) {
      cross(slot);
    } else {
      advance(slot);
    }
    if (!spins_.empty()) spins_[i].turn(params_.turn);
    if (box(slot) == before) continue;
    tell_update(slot, step);
    spoil(step.updated_boxes.back());
  }
}

void GeneratedScene::shake(SceneStep& step) {
  if (params_.jitter == 0) return;
  for (std::size_t i = moving_count_; i < slots_.size(); ++i) {
    Slot& slot = slots_[i];
    if (slot.filled_in_step == step_ || slot.covers) continue;
    const SceneBox before = box(slot);
    for (std::size_t axis = 0; axis < dim_; ++axis) {
      slot.shift[axis] = params_.jitter * params_.width * random_.between(-1, 1);
    }
    if (box(slot) != before) tell_update(slot, step);
  }
}

void GeneratedScene::append(const Slot& slot, std::vector<SceneKey>& keys, std::vector<SceneBox>& boxes,
                            std::vector<OrientedBox>& shapes) const {
  keys.push_back(slot.key);
  boxes.push_back(box(slot));
  if (!spins_.empty()) shapes.push_back(shape(slot));
}

void GeneratedScene::tell_insert(const Slot& slot, SceneStep& step) const {
  append(slot, step.inserted, step.inserted_boxes, step.inserted_shapes);
}

void GeneratedScene::tell_update(const Slot& slot, SceneStep& step) const {
  append(slot, step.updated, step.updated_boxes, step.updated_shapes);
}

void GeneratedScene::fill(Slot& slot) {
  slot.key = next_key_++;
  slot.filled_in_step = step_;
  place(slot);
}

void GeneratedScene::place(Slot& slot) {
  const Vector* centre = clump_centres_.empty() ? nullptr : &clump_centres_[random_.below(clump_centres_.size())];
  for (std::size_t axis = 0; axis < dim_; ++axis) {
    const double room = world_[axis] - slot.width;
    if (centre == nullptr) {
      slot.low[axis] = random_.between(0, room);
      continue;
    }
    const double low = (*centre)[axis] + params_.spread * world_[axis] * random_.bell() - slot.width / 2;
    slot.low[axis] = std::clamp(low, 0.0, room);
  }
  slot.shift = {};
}

// To and fro by `speed` widths over the border that is nearest to its place on each axis.
void GeneratedScene::cross(Slot& slot) const {
  const double spacing = params_.cross * params_.width;
  const double side = (step_ % 2 == 0 ? -0.5 : 0.5) * params_.speed * params_.width;
  for (std::size_t axis = 0; axis < dim_; ++axis) {
    slot.low[axis] = std::floor(slot.low[axis] / spacing + 0.5) * spacing;
    slot.shift[axis] = side;
  }
}

void GeneratedScene::advance(Slot& slot) const {
  for (std::size_t axis = 0; axis < dim_; ++axis) {
    const double room = world_[axis] - slot.width;
    double low = slot.low[axis] + slot.velocity[axis];
    if (low < 0 || low > room) {
      // Back and forth between the walls, as often as the step is longer than the room.
      const double way = room > 0 ? std::fmod(std::abs(low), 2 * room) : 0;
      if ((low < 0) != (way > room)) slot.velocity[axis] = -slot.velocity[axis];
      low = way > room ? 2 * room - way : way;
    }
    slot.low[axis] = std::clamp(low, 0.0, room);  // against rounding
  }
}

GeneratedScene::Vector GeneratedScene::random_direction() {
  // A point of the ball, drawn from the cube around it, scaled to length 1.
  while (true) {
    Vector direction{};
    double squared = 0;
    for (std::size_t axis = 0; axis < dim_; ++axis) {
      direction[axis] = random_.between(-1, 1);
      squared += direction[axis] * direction[axis];
    }
    if (squared > 1 || squared < 0x1p-20) continue;
    const double length = std::sqrt(squared);
    for (double& component : direction) component /= length;
    return direction;
  }
}

SceneBox GeneratedScene::box(const Slot& slot) const {
  if (slot.covers) return *info_.bounds;
  if (!spins_.empty()) {
    SceneBox bounds = shape(slot).bounds();
    if (dim_ == 2) bounds.min[2] = bounds.max[2] = 0;
    return bounds;
  }
  SceneBox result({0, 0, 0}, {0, 0, 0});
  for (std::size_t axis = 0; axis < dim_; ++axis) {
    double low = slot.low[axis] + slot.shift[axis];
    if (params_.snap > 0) {
      const double pitch = params_.snap * params_.width;
      low = std::floor(low / pitch + 0.5) * pitch;
    }
    result.min[axis] = offset_ + low;
    result.max[axis] = result.min[axis] + (axis == axis_ ? slot.width * params_.thin : slot.width);
  }
  if (slot.reaches > 0) result.max[axis_] = std::numeric_limits<double>::infinity();
  if (slot.reaches < 0) result.min[axis_] = -std::numeric_limits<double>::infinity();
  return result;
}

OrientedBox GeneratedScene::shape(const Slot& slot) const {
  Vector centre{};
  for (std::size_t axis = 0; axis < dim_; ++axis) {
    centre[axis] = offset_ + (slot.low[axis] + slot.shift[axis] + slot.width / 2);
  }
  return spins_[static_cast<std::size_t>(&slot - slots_.data())].shape(centre, slot.width);
}

void GeneratedScene::spoil(SceneBox& box) {
  if (params_.nan > 0 && random_.unit() < params_.nan) {
    const std::size_t axis = random_.below(dim_);
    (random_.below(2) == 0 ? box.min : box.max)[axis] = std::numeric_limits<double>::quiet_NaN();
  }
  if (params_.inverted > 0 && random_.unit() < params_.inverted) {
    const std::size_t axis = random_.below(dim_);
    std::swap(box.min[axis], box.max[axis]);
    if (!(box.min[axis] > box.max[axis])) box.min[axis] = std::numeric_limits<double>::infinity();  // had no extent
  }
}

}  // namespace sweepgrid
