#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <sweepgrid/engine/handle.hpp>
#include <sweepgrid/scheduler/executor.hpp>

namespace sweepgrid {

/// Items of a bulk call that one worker takes in ascending order: a range, or a list.
class Items {
 public:
  Items() = default;
  Items(std::size_t first, std::size_t count) : first_(first), count_(count) {}
  explicit Items(std::span<const std::uint32_t> list) : list_(list.data()), count_(list.size()) {}

  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] bool listed() const { return list_ != nullptr; }
  [[nodiscard]] std::size_t operator[](std::size_t i) const { return list_ != nullptr ? list_[i] : first_ + i; }

 private:
  const std::uint32_t* list_ = nullptr;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

/// Items [0, count) of a bulk call by part, those of each part in ascending order; made in parallel. An item is kept as
/// an Entry.
template <class Entry>
class ItemPartition {
 public:
  /// Items that one task takes, where they are cut by their number: some ten times as long as it takes to steal it.
  static constexpr std::size_t kChunk = 2048;
  [[nodiscard]] static std::size_t chunks(std::size_t count) { return (count + kChunk - 1) / kChunk; }
  /// [first, end) of a chunk.
  [[nodiscard]] static std::pair<std::size_t, std::size_t> chunk(std::size_t index, std::size_t count) {
    return {index * kChunk, std::min(count, (index + 1) * kChunk)};
  }

  /// `part_of(item)` < parts; `entry_of(item)` is what is kept. O(count + chunks * parts).
  template <class PartOf, class EntryOf>
  void assign(Executor& executor, std::size_t count, std::size_t parts, PartOf&& part_of, EntryOf&& entry_of) {
    const std::size_t tasks = chunks(count);
    // Of each chunk, for each part: how many, and then where the next one goes.
    std::vector<std::size_t> places(tasks * parts, 0);
    executor.for_each(tasks, [&](std::size_t task) {
      const auto [first, end] = chunk(task, count);
      for (std::size_t item = first; item < end; ++item) ++places[task * parts + part_of(item)];
    });
    std::size_t place = 0;
    ends_.clear();
    for (std::size_t part = 0; part < parts; ++part) {
      for (std::size_t task = 0; task < tasks; ++task) place += std::exchange(places[task * parts + part], place);
      ends_.push_back(place);
    }
    entries_ = std::make_unique_for_overwrite<Entry[]>(count);
    executor.for_each(tasks, [&](std::size_t task) {
      const auto [first, end] = chunk(task, count);
      for (std::size_t item = first; item < end; ++item) {
        entries_[places[task * parts + part_of(item)]++] = entry_of(item);
      }
    });
  }

  [[nodiscard]] std::size_t parts() const { return ends_.size(); }
  [[nodiscard]] std::span<const Entry> part(std::size_t index) const {
    const std::size_t first = index == 0 ? 0 : ends_[index - 1];
    return {&entries_[first], ends_[index] - first};
  }

 private:
  std::vector<std::size_t> ends_;
  std::unique_ptr<Entry[]> entries_;
};

/// The items of a bulk call that names objects, cut so that no object is in two parts.
class ObjectPartition {
 public:
  ObjectPartition(Executor& executor, std::span<const Handle> objects);
  /// One part.
  explicit ObjectPartition(std::size_t count) : count_(count), ranges_(1) {}

  [[nodiscard]] std::size_t parts() const { return lists_.parts() > 0 ? lists_.parts() : ranges_; }
  [[nodiscard]] Items part(std::size_t index) const {
    if (lists_.parts() > 0) return Items(lists_.part(index));
    if (ranges_ == 1) return Items(0, count_);
    const auto [first, end] = Lists::chunk(index, count_);
    return Items(first, end - first);
  }

 private:
  using Lists = ItemPartition<std::uint32_t>;

  std::size_t count_;
  std::size_t ranges_;
  Lists lists_;  // where ranges of items share objects
};

}  // namespace sweepgrid
