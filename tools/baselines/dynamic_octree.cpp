#include "baselines/dynamic_octree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

namespace sweepgrid::baselines {
namespace {

void forget(std::vector<ObjectId>& objects, ObjectId object) {
  *std::find(objects.begin(), objects.end(), object) = objects.back();
  objects.pop_back();
}

Pair<ObjectId> pair_of(ObjectId a, ObjectId b) { return {std::min(a, b), std::max(a, b)}; }

void sort_pairs(std::vector<Pair<ObjectId>>& pairs) {
  std::sort(pairs.begin(), pairs.end(), [](const Pair<ObjectId>& a, const Pair<ObjectId>& b) {
    return a.first != b.first ? a.first < b.first : a.second < b.second;
  });
}

// Without branches, because most tests fail, but each on another axis.
template <class Scalar>
bool overlap(const Box<Scalar, 3>& a, const Box<Scalar, 3>& b) {
  bool meet = true;
  for (int axis = 0; axis < 3; ++axis) meet &= (a.min[axis] <= b.max[axis]) & (b.min[axis] <= a.max[axis]);
  return meet;
}

std::size_t checked_leaf_size(const OctreeOptions& options) {
  if (options.leaf_size < 1) throw std::invalid_argument("octree: leaf_size is below 1");
  return static_cast<std::size_t>(options.leaf_size);
}

}  // namespace

template <class Scalar>
DynamicOctree<Scalar>::DynamicOctree(const OctreeOptions& options)
    : nodes_(checked_leaf_size(options), counters_), leaf_size_(checked_leaf_size(options)) {}

template <class Scalar>
void DynamicOctree<Scalar>::insert(ObjectId object, const BoxType& box) {
  if (object < objects_.size() && objects_[object].present) {
    throw std::invalid_argument("octree: object " + std::to_string(object) + " is present already");
  }
  require_valid(object, box);
  if (object >= objects_.size()) objects_.resize(std::size_t{object} + 1);
  objects_[object].present = true;
  ++size_;
  change(object, box);
}

template <class Scalar>
void DynamicOctree<Scalar>::update(ObjectId object, const BoxType& box) {
  require_present(object);
  require_valid(object, box);
  change(object, box);
}

template <class Scalar>
void DynamicOctree<Scalar>::erase(ObjectId object) {
  Object& gone = require_present(object);
  for (const ObjectId other : gone.pairs) {
    pending_.ends.push_back(pair_of(object, other));
    forget(objects_[other].pairs, object);
  }
  gone.pairs.clear();
  gone.present = false;
  --size_;
  nodes_.take(object);
}

template <class Scalar>
auto DynamicOctree<Scalar>::require_present(ObjectId object) -> Object& {
  if (object < objects_.size() && objects_[object].present) return objects_[object];
  throw std::invalid_argument("octree: object " + std::to_string(object) + " is absent");
}

template <class Scalar>
void DynamicOctree<Scalar>::require_valid(ObjectId object, const BoxType& box) {
  if (box.valid()) return;
  throw std::invalid_argument("octree: the box of object " + std::to_string(object) + " has a NaN or min > max");
}

template <class Scalar>
void DynamicOctree<Scalar>::change(ObjectId object, const BoxType& box) {
  objects_[object].box = box;
  if (!std::exchange(objects_[object].changed, true)) changed_.push_back(object);
}

template <class Scalar>
const Events<ObjectId>& DynamicOctree<Scalar>::step() {
  std::erase_if(changed_, [&](ObjectId object) {
    objects_[object].changed = false;
    return !objects_[object].present;
  });
  place_changed();
  for (const ObjectId object : changed_) end_pairs(object);
  for (const ObjectId object : changed_) begin_pairs(object);
  changed_.clear();
  std::swap(events_, pending_);
  pending_.ends.clear();
  pending_.begins.clear();
  sort_pairs(events_.ends);
  sort_pairs(events_.begins);
  return events_;
}

template <class Scalar>
void DynamicOctree<Scalar>::place_changed() {
  for (const ObjectId object : changed_) {
    outsiders_ += nodes_.root().reached_beyond_by(objects_[object].box) ? 1 : 0;
  }
  if (outsiders_ > leaf_size_ + size_ / 8) {
    fit_root();
  } else {
    for (const ObjectId object : changed_) nodes_.put(object, objects_[object].box);
  }
}

// Around all but the outermost 32nd at either end of each axis, with room: a few objects far away would make a root in
// which all others share one leaf.
template <class Scalar>
void DynamicOctree<Scalar>::fit_root() {
  ++counters_.roots_fitted;
  outsiders_ = 0;
  OctreeCell<Scalar> root;
  std::vector<Scalar> places;
  for (int axis = 0; axis < 3; ++axis) {
    places.clear();
    for (const Object& object : objects_) {
      const Scalar place = object.box.min[axis] / 2 + object.box.max[axis] / 2;
      if (object.present && std::isfinite(place)) places.push_back(place);
    }
    if (places.empty()) continue;
    const auto cut = static_cast<std::ptrdiff_t>(places.size() / 32);
    std::nth_element(places.begin(), places.begin() + cut, places.end());
    const Scalar low = places[static_cast<std::size_t>(cut)];
    std::nth_element(places.begin(), places.end() - 1 - cut, places.end());
    const Scalar high = *(places.end() - 1 - cut);
    root.centre[axis] = low / 2 + high / 2;
    // Limited, so that no plane of a child overflows.
    const Scalar edge = (high / 2 - low / 2) * Scalar{2.75};
    root.edge = std::max(root.edge, std::min(edge, std::numeric_limits<Scalar>::max() / 8));
  }
  nodes_.reset(root);
  for (ObjectId object = 0; object < objects_.size(); ++object) {
    if (objects_[object].present) nodes_.put(object, objects_[object].box);
  }
}

template <class Scalar>
void DynamicOctree<Scalar>::end_pairs(ObjectId object) {
  Object& changed = objects_[object];
  std::erase_if(changed.pairs, [&](ObjectId other) {
    if (overlap(changed.box, objects_[other].box)) return false;
    pending_.ends.push_back(pair_of(object, other));
    forget(objects_[other].pairs, object);
    return true;
  });
}

template <class Scalar>
void DynamicOctree<Scalar>::begin_pairs(ObjectId object) {
  Object& changed = objects_[object];
  // A mark for what is known spares a search among the pairs for each box that is met.
  if (++search_ == 0) {
    for (Object& other : objects_) other.seen = 0;
    search_ = 1;
  }
  changed.seen = search_;
  for (const ObjectId other : changed.pairs) objects_[other].seen = search_;
  const BoxType box = changed.box;
  nodes_.visit(object, [&](std::span<const typename OctreeNodes<Scalar>::Entry> entries) {
    ++counters_.lists_visited;
    counters_.box_tests += entries.size();
    for (const auto& entry : entries) {
      if (!overlap(box, entry.box)) continue;
      Object& other = objects_[entry.object];
      if (std::exchange(other.seen, search_) == search_) continue;
      pending_.begins.push_back(pair_of(object, entry.object));
      changed.pairs.push_back(entry.object);
      other.pairs.push_back(object);
    }
  });
}

template <class Scalar>
std::size_t DynamicOctree<Scalar>::bytes() const {
  std::size_t total = nodes_.bytes() + objects_.capacity() * sizeof(Object) + changed_.capacity() * sizeof(ObjectId);
  for (const Object& object : objects_) total += object.pairs.capacity() * sizeof(ObjectId);
  for (const Events<ObjectId>* events : {&pending_, &events_}) {
    total += (events->ends.capacity() + events->begins.capacity()) * sizeof(Pair<ObjectId>);
  }
  return total;
}

template <class Scalar>
void DynamicOctree<Scalar>::validate() const {
  nodes_.validate();
  for (ObjectId id = 0; id < objects_.size(); ++id) {
    for (const ObjectId other : objects_[id].pairs) {
      const auto& back = objects_[other].pairs;
      if (std::count(back.begin(), back.end(), id) != 1 || !overlap(objects_[id].box, objects_[other].box)) {
        throw std::logic_error("octree: the pair " + std::to_string(id) + ", " + std::to_string(other) + " is wrong");
      }
    }
  }
}

template class DynamicOctree<float>;
template class DynamicOctree<double>;

}  // namespace sweepgrid::baselines
