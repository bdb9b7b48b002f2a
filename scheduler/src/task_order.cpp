#include "task_order.hpp"

#include <algorithm>
#include <numeric>

namespace sweepgrid {

void TaskOrder::assign_descending(std::span<const std::uint64_t> costs) {
  tasks_.resize(costs.size());
  std::iota(tasks_.begin(), tasks_.end(), std::uint32_t{0});
  std::sort(tasks_.begin(), tasks_.end(),
            [&](std::uint32_t a, std::uint32_t b) { return costs[a] != costs[b] ? costs[a] > costs[b] : a < b; });
}

void TaskOrder::assign_for_stealing(std::span<const std::uint64_t> costs) {
  assign_descending(costs);
  descending_.swap(tasks_);
  const auto count = static_cast<std::uint32_t>(descending_.size());
  tasks_.resize(count);
  if (count == 0) return;
  // Breadth first over the halves as the executor splits them: [begin, middle) stays, [middle, end) can be stolen.
  std::uint32_t rank = 0;
  tasks_[0] = descending_[rank++];
  ranges_.assign(1, {0, count});
  for (std::size_t i = 0; rank != count; ++i) {
    const Range range = ranges_[i];
    if (range.end - range.begin < 2) continue;
    const std::uint32_t middle = range.begin + (range.end - range.begin) / 2;
    tasks_[middle] = descending_[rank++];
    ranges_.push_back({range.begin, middle});
    ranges_.push_back({middle, range.end});
  }
}

}  // namespace sweepgrid
