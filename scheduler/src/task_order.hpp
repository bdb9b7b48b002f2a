#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sweepgrid {

/// The order in which a stage's tasks start. Keeps its buffers from run to run. Not thread-safe.
class TaskOrder {
 public:
  /// Heaviest first, equal costs by task index. For an executor that takes indices in order.
  void assign_descending(std::span<const std::uint64_t> costs);

  /// Heaviest first for workers that steal by recursive halving: the task at the start of every half is at least as
  /// heavy as all that begin deeper.
  void assign_for_stealing(std::span<const std::uint64_t> costs);

  [[nodiscard]] std::size_t size() const { return tasks_.size(); }
  [[nodiscard]] std::uint32_t task(std::size_t place) const { return tasks_[place]; }
  /// Heap bytes held.
  [[nodiscard]] std::size_t bytes() const {
    return (tasks_.capacity() + descending_.capacity()) * sizeof(std::uint32_t) + ranges_.capacity() * sizeof(Range);
  }

 private:
  struct Range {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
  };

  std::vector<std::uint32_t> tasks_;
  std::vector<std::uint32_t> descending_;
  std::vector<Range> ranges_;
};

}  // namespace sweepgrid
