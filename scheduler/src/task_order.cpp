#include "task_order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

namespace sweepgrid {
namespace {

// Bundles a worker on average: enough that the last ones to end differ little, few enough that spawning is noise.
constexpr double kBundlesPerWorker = 64;

// No task is free to start.
double weight(std::uint64_t cost) { return static_cast<double>(std::max<std::uint64_t>(cost, 1)); }

constexpr std::size_t kRadixThreshold = 512;
constexpr int kRadixBits = 11;
constexpr std::size_t kRadixSize = std::size_t{1} << kRadixBits;

// Stable, so that equal costs stay by task index. Takes over from std::sort where tens of thousands of cells would
// make the sort a serial part of the step that is worth noticing.
void radix_sort_descending(std::span<const std::uint64_t> costs, std::uint64_t heaviest,
                           std::vector<std::uint32_t>& tasks, std::vector<std::uint32_t>& buffer) {
  buffer.resize(tasks.size());
  for (int shift = 0; shift < static_cast<int>(std::bit_width(heaviest)); shift += kRadixBits) {
    const auto digit = [&](std::uint32_t task) { return ~(costs[task] >> shift) & (kRadixSize - 1); };
    std::array<std::uint32_t, kRadixSize> next{};
    for (const std::uint32_t task : tasks) ++next[digit(task)];
    std::exclusive_scan(next.begin(), next.end(), next.begin(), std::uint32_t{0});
    for (const std::uint32_t task : tasks) buffer[next[digit(task)]++] = task;
    tasks.swap(buffer);
  }
}

}  // namespace

void TaskOrder::assign_descending(std::span<const std::uint64_t> costs) {
  sort_tasks(costs);
  bundles_.resize(costs.size());
  for (std::uint32_t i = 0; i != bundles_.size(); ++i) bundles_[i] = {i, 1};
}

void TaskOrder::assign_for_stealing(std::span<const std::uint64_t> costs, int workers) {
  sort_tasks(costs);
  bundle_light_tasks(costs, workers);
  arrange_by_halving();
}

void TaskOrder::sort_tasks(std::span<const std::uint64_t> costs) {
  tasks_.resize(costs.size());
  std::iota(tasks_.begin(), tasks_.end(), std::uint32_t{0});
  if (costs.size() < kRadixThreshold) {
    std::sort(tasks_.begin(), tasks_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return costs[a] != costs[b] ? costs[a] > costs[b] : a < b; });
  } else {
    radix_sort_descending(costs, *std::max_element(costs.begin(), costs.end()), tasks_, sort_buffer_);
  }
}

void TaskOrder::bundle_light_tasks(std::span<const std::uint64_t> costs, int workers) {
  // In double: a sum of costs in the stage's own unit may not fit 64 bits.
  double total = 0;
  for (const std::uint64_t cost : costs) total += weight(cost);
  const double limit = total / (kBundlesPerWorker * workers);

  descending_bundles_.clear();
  double bundled = 0;
  for (std::uint32_t i = 0; i != tasks_.size(); ++i) {
    const double added = weight(costs[tasks_[i]]);
    if (i == 0 || bundled + added > limit) {
      descending_bundles_.push_back({i, 0});
      bundled = 0;
    }
    ++descending_bundles_.back().count;
    bundled += added;
  }
}

void TaskOrder::arrange_by_halving() {
  const auto count = static_cast<std::uint32_t>(descending_bundles_.size());
  bundles_.resize(count);
  if (count == 0) return;
  // Breadth first over the halves as the executor splits them: [begin, middle) stays, [middle, end) can be stolen.
  std::uint32_t rank = 0;
  bundles_[0] = descending_bundles_[rank++];
  ranges_.assign(1, {0, count});
  for (std::size_t i = 0; rank != count; ++i) {
    const Range range = ranges_[i];
    if (range.end - range.begin < 2) continue;
    const std::uint32_t middle = range.begin + (range.end - range.begin) / 2;
    bundles_[middle] = descending_bundles_[rank++];
    ranges_.push_back({range.begin, middle});
    ranges_.push_back({middle, range.end});
  }
}

}  // namespace sweepgrid
