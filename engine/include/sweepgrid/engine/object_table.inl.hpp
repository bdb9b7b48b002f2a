#pragma once

#include <algorithm>
#include <stdexcept>

#include <sweepgrid/engine/object_table.hpp>

namespace sweepgrid {

// ---- one object

template <class Scalar, int Dim>
Handle ObjectTable<Scalar, Dim>::insert(const BoxType& box) {
  ObjectId object;
  bool fresh = false;
  {
    const std::lock_guard lock(allocation_);
    if (!free_.empty()) {
      object = free_.back();
      free_.pop_back();
    } else {
      object = extend(1);
      fresh = true;
    }
  }
  occupy(object, fresh, box);
  mark(object);
  measure(WidthLevels::width(box));
  live_.fetch_add(1, std::memory_order_relaxed);
  return handle(object);
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::cancel_insert(ObjectId object) {
  live_.fetch_sub(1, std::memory_order_relaxed);
  retire(object);
  const std::lock_guard lock(allocation_);
  ++latest_generation_;
  free_after_failure(object);
}

template <class Scalar, int Dim>
bool ObjectTable<Scalar, Dim>::update(Handle object, const BoxType& box) {
  if (!good(object) || !box.valid()) return false;
  if (!replace(object.index, box)) return true;
  something_queued();
  if (WidthLevels::wider(box, widest_.load(std::memory_order_relaxed))) [[unlikely]]
    measure(WidthLevels::width(box));
  return true;
}

// Returns whether the object has a queued op now.
template <class Scalar, int Dim>
inline bool ObjectTable<Scalar, Dim>::replace(ObjectId object, const BoxType& box) {
  Record& record = records_[object];
  const std::uint8_t state = states_[object];
  if ((state & kQueued) == 0) {
    if (same_bits(record.box, box)) return false;  // a resting object that its client reports anyway costs nothing more
    record.before = record.box;
    set_state(object, state | kUpdated);
    mark_granule(object / kGranule);
  }
  record.box = box;
  return true;
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::erase(ObjectId object) {
  if ((states_[object] & kQueued) == 0) records_[object].before = records_[object].box;
  set_state(object, states_[object] | kErased);
  mark(object);
  live_.fetch_sub(1, std::memory_order_relaxed);
}

template <class Scalar, int Dim>
std::span<const ObjectId> ObjectTable<Scalar, Dim>::sample(std::span<ObjectId> room) const {
  const std::size_t wanted = std::min(room.size(), size());
  const auto alive = [](std::uint8_t state) { return (state & (kLive | kErased)) == kLive; };
  std::size_t chosen = 0;
  std::size_t passed = 0;  // objects
  for (std::uint32_t granule = 0; granule < granules() && chosen < wanted; ++granule) {
    const ObjectId first = granule * kGranule;
    const std::uint32_t count = std::min(bound() - first, kGranule);
    const std::uint8_t* const states = &states_[first];  // a granule is contiguous
    std::size_t here = 0;
    for (std::uint32_t i = 0; i < count; ++i) here += alive(states[i]) ? 1 : 0;
    std::uint64_t next = any_of_run(chosen, wanted, size()) - passed;
    passed += here;
    if (next >= here) continue;
    std::size_t seen = 0;
    for (std::uint32_t i = 0; i < count && chosen < wanted; ++i) {
      if (!alive(states[i]) || seen++ != next) continue;
      room[chosen++] = first + i;
      next = any_of_run(chosen, wanted, size()) - (passed - here);
    }
  }
  return room.first(chosen);
}

// ---- many

template <class Scalar, int Dim>
auto ObjectTable<Scalar, Dim>::reserve(std::size_t count) -> NewIds {
  NewIds ids;
  ids.count_ = count;
  const std::lock_guard lock(allocation_);
  const auto reused = static_cast<std::ptrdiff_t>(std::min(count, free_.size()));
  ids.reused_.assign(free_.rbegin(), free_.rbegin() + reused);
  ids.first_ = extend(count - ids.reused_.size());
  free_.resize(free_.size() - ids.reused_.size());
  return ids;
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::begin_insert(Share& share, const NewIds& ids, std::span<const BoxType> boxes,
                                            std::span<Handle> handles) {
  for (; share.done < share.items.size(); ++share.done) {
    const std::size_t item = share.items[share.done];
    if (!boxes[item].valid()) break;
    const ObjectId object = ids[item];
    occupy(object, ids.fresh(item), boxes[item]);
    mark_granule(object / kGranule);
    handles[item] = handle(object);
    widen(share.widest, boxes[item]);
  }
  share.checked = share.done;
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::finish_insert(const Share& share) {
  if (share.done == 0) return;
  live_.fetch_add(share.done, std::memory_order_relaxed);
  measure(share.widest);
  something_queued();
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::cancel_insert(const NewIds& ids) {
  for (std::size_t item = 0; item < ids.count_; ++item) {
    set_state(ids[item], 0);
    mark_granule(ids[item] / kGranule);
  }
  const std::lock_guard lock(allocation_);
  // Nobody was told of these ids, so they need no new generation.
  const auto fresh = static_cast<ObjectId>(ids.count_ - ids.reused_.size());
  if (ids.first_ + fresh == bound()) {
    bound_.store(ids.first_, std::memory_order_release);
  } else {
    for (ObjectId object = ids.first_ + fresh; object-- > ids.first_;) {
      renew(object);
      free_after_failure(object);
    }
  }
  free_.insert(free_.end(), ids.reused_.rbegin(), ids.reused_.rend());
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::begin_update(Share& share, std::span<const Handle> objects,
                                            std::span<const BoxType> boxes) {
  const ObjectId end = bound();
  Share now = share;  // the compiler cannot know that marks are not written into `share`
  now.widest = widest_.load(std::memory_order_relaxed);
  bool applies = true;
  for (; now.checked < now.items.size(); ++now.checked) {
    prefetch(now.items, now.checked, objects, boxes.data(), end);
    const std::size_t item = now.items[now.checked];
    const Handle object = objects[item];
    if (object.index >= end) break;
    if (!is(object) || !boxes[item].valid()) break;
    applies = applies && (states_[object.index] & kQueued) == 0;
    if (!applies) continue;
    ++now.done;
    now.queued |= replace(object.index, boxes[item]);
    widen(now.widest, boxes[item]);
  }
  share = now;
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::finish_update(Share& share, std::span<const Handle> objects,
                                             std::span<const BoxType> boxes) {
  const ObjectId end = bound();
  Share now = share;
  for (; now.done < now.items.size(); ++now.done) {
    prefetch(now.items, now.done, objects, boxes.data(), end);
    const std::size_t item = now.items[now.done];
    now.queued |= replace(objects[item].index, boxes[item]);
    widen(now.widest, boxes[item]);
  }
  share = now;
  if (!share.queued) return;
  measure(share.widest);
  something_queued();
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::cancel_update(const Share& share, std::span<const Handle> objects) {
  for (std::size_t i = 0; i < share.done; ++i) {
    const ObjectId object = objects[share.items[i]].index;
    if ((states_[object] & kUpdated) == 0) continue;  // an item that changed nothing, or taken back already
    records_[object].box = records_[object].before;
    set_state(object, states_[object] & static_cast<std::uint8_t>(~kUpdated));
  }
  mark_all(share, objects);
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::begin_erase(Share& share, std::span<const Handle> objects) {
  const ObjectId end = bound();
  for (; share.done < share.items.size(); ++share.done) {
    prefetch(share.items, share.done, objects, nullptr, end);
    const Handle object = objects[share.items[share.done]];
    if (object.index >= end) break;
    if (!is(object)) break;
    Record& record = records_[object.index];
    const std::uint8_t state = states_[object.index];
    if ((state & kQueued) == 0) record.before = record.box;
    set_state(object.index, state | kErased);
    mark_granule(object.index / kGranule);
  }
  share.checked = share.done;
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::finish_erase(const Share& share) {
  if (share.done == 0) return;
  live_.fetch_sub(share.done, std::memory_order_relaxed);
  something_queued();
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::cancel_erase(const Share& share, std::span<const Handle> objects) {
  for (std::size_t i = 0; i < share.done; ++i) {
    const ObjectId object = objects[share.items[i]].index;
    set_state(object, states_[object] & static_cast<std::uint8_t>(~kErased));
  }
  mark_all(share, objects);
}

// What is marked must not depend on how far which share had come.
template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::mark_all(const Share& share, std::span<const Handle> objects) {
  const ObjectId end = bound();
  for (std::size_t i = 0; i < share.items.size(); ++i) {
    const ObjectId object = objects[share.items[i]].index;
    if (object < end) mark_granule(object / kGranule);
  }
}

// ---- ids

// Makes new ids; returns the first.
template <class Scalar, int Dim>
ObjectId ObjectTable<Scalar, Dim>::extend(std::size_t count) {
  const ObjectId first = bound();
  if (count > kNoObject - first) throw std::length_error("sweepgrid: more than 2^32 - 1 objects");
  const ObjectId end = first + static_cast<ObjectId>(count);
  if (end == first) return first;
  records_.grow(end);
  states_.grow(end);
  marks_.grow((end - 1) / kGranule + std::uint64_t{1});
  for (ObjectId object = first; object < end; ++object) states_[object] = 0;  // stale handles may be tried
  trim_at_ = end / 4;
  bound_.store(end, std::memory_order_release);
  return first;
}

template <class Scalar, int Dim>
void ObjectTable<Scalar, Dim>::occupy(ObjectId object, bool fresh, const BoxType& box) {
  Record& record = records_[object];
  record.box = box;
  if (fresh) renew(object);
  set_state(object, kLive | kInserted);
}

template <class Scalar, int Dim>
bool ObjectTable<Scalar, Dim>::trim() {
  if (size() > trim_at_) return false;
  ObjectId end = bound();
  while (end > 0 && states_[end - 1] == 0) --end;
  trim_at_ = size() / 2;
  if (end == bound()) return false;
  std::erase_if(free_, [&](ObjectId object) { return object >= end; });
  free_.shrink_to_fit();
  bound_.store(end, std::memory_order_release);
  records_.shrink(end);
  states_.shrink(end);
  marks_.shrink(granules_of(end));
  first_generation_ = latest_generation_;
  return true;
}

}  // namespace sweepgrid
