#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sweepgrid {

/// The order in which a stage's tasks start. Keeps its buffers from run to run. Not thread-safe.
class TaskOrder {
 public:
  /// Heaviest first, equal costs by task index; one task a bundle. For an executor that takes indices in order.
  void assign_descending(std::span<const std::uint64_t> costs);

  /// Heaviest first for `workers` workers that steal by recursive halving: the bundle at the start of every half is
  /// heavier than all that begin deeper. Light tasks share a bundle, so that spawning does not cost more than they do.
  void assign_for_stealing(std::span<const std::uint64_t> costs, int workers);

  [[nodiscard]] std::size_t bundle_count() const { return bundles_.size(); }
  [[nodiscard]] std::span<const std::uint32_t> tasks(std::size_t bundle) const {
    return std::span(tasks_).subspan(bundles_[bundle].first, bundles_[bundle].count);
  }

 private:
  struct Bundle {
    std::uint32_t first = 0;  ///< position in tasks_
    std::uint32_t count = 0;
  };
  struct Range {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
  };

  void sort_tasks(std::span<const std::uint64_t> costs);
  void bundle_light_tasks(std::span<const std::uint64_t> costs, int workers);
  void arrange_by_halving();

  std::vector<std::uint32_t> tasks_;  ///< by descending cost
  std::vector<std::uint32_t> sort_buffer_;
  std::vector<Bundle> bundles_;
  std::vector<Bundle> descending_bundles_;
  std::vector<Range> ranges_;
};

}  // namespace sweepgrid
