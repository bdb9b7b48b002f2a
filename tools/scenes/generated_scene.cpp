#include "scenes/generated_scene.hpp"

#include <algorithm>
#include <cmath>
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
    : params_(params), random_(params.seed), dim_(params.dim), slots_(params.n) {
  moving_count_ = static_cast<std::size_t>(std::floor(params_.moving * static_cast<double>(params_.n) + 0.5));
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    slots_[i].width = quota(params_.large, i) > 0 ? params_.width * params_.scale : params_.width;
  }
  deck_.resize(slots_.size());
  std::iota(deck_.begin(), deck_.end(), 0U);
  lay_out_world();
  for (std::uint64_t i = 0; i < params_.clusters; ++i) {
    Vector& centre = clump_centres_.emplace_back();
    for (std::size_t axis = 0; axis < dim_; ++axis) centre[axis] = random_.between(0, world_[axis]);
  }
  info_.name = std::move(name);
  info_.format = "generator";
  info_.compression = "none";
  info_.dim = static_cast<int>(dim_);
  info_.bounds = SceneBox({0, 0, 0}, world_);
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
  const std::size_t flat_axis = dim_ - 1;
  const double height = std::max(params_.layers * params_.width, widest);
  const bool flat = params_.layers > 0;
  if (flat) volume /= height;
  const std::size_t other_axes = flat ? dim_ - 1 : dim_;
  const double edge = other_axes == 3 ? cube_root(volume) : other_axes == 2 ? std::sqrt(volume) : volume;
  for (std::size_t axis = 0; axis < dim_; ++axis) {
    world_[axis] = flat && axis == flat_axis ? height : std::max(edge, widest);
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
    step.inserted.push_back(slot.key);
    step.inserted_boxes.push_back(box(slot));
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
    step.inserted.push_back(slot.key);
    step.inserted_boxes.push_back(box(slot));
  }
}

void GeneratedScene::move(SceneStep& step) {
  for (std::size_t i = 0; i < moving_count_; ++i) {
    Slot& slot = slots_[i];
    if (slot.filled_in_step == step_) continue;
    const Vector before = slot.low;
    if (params_.teleport > 0 && random_.unit() < params_.teleport) {
      place(slot);
    } else {
      advance(slot);
    }
    if (slot.low == before) continue;
    step.updated.push_back(slot.key);
    step.updated_boxes.push_back(box(slot));
  }
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
}

void GeneratedScene::advance(Slot& slot) const {
  for (std::size_t axis = 0; axis < dim_; ++axis) {
    const double room = world_[axis] - slot.width;
    double low = slot.low[axis] + slot.velocity[axis];
    if (low < 0 || low > room) {
      low = low < 0 ? -low : 2 * room - low;
      slot.velocity[axis] = -slot.velocity[axis];
    }
    slot.low[axis] = std::clamp(low, 0.0, room);  // for steps longer than the room
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
  SceneBox result;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.min[axis] = slot.low[axis];
    result.max[axis] = axis < dim_ ? slot.low[axis] + slot.width : 0;
  }
  return result;
}

}  // namespace sweepgrid
