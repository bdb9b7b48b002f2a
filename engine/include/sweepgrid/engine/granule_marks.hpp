#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include <sweepgrid/engine/stable_vector.hpp>

namespace sweepgrid {

/// Marks on granules of objects, in two levels: so a step finds the few that are marked among those of millions of
/// objects that rest.
///
/// Thread-safety: mark() may be called at once from many threads, beside grow(); the rest may not.
class GranuleMarks {
 public:
  /// Makes marks for so many granules; new ones are not set.
  void grow(std::uint64_t granules) {
    grow(marks_, granules);
    grow(groups_, (granules + kGroup - 1) / kGroup);
  }
  void shrink(std::uint64_t granules) {
    marks_.shrink(granules);
    groups_.shrink((granules + kGroup - 1) / kGroup);
  }
  [[nodiscard]] std::size_t bytes() const { return marks_.bytes() + groups_.bytes(); }

  // Neighbours of different threads share a granule, so this is atomic; checked first to keep the line shared.
  [[gnu::always_inline]] void mark(std::uint32_t granule) {
    if (set(marks_[granule])) set(groups_[granule / kGroup]);
  }
  void unmark(std::uint32_t granule) { marks_[granule] = 0; }
  [[nodiscard]] bool marked(std::uint32_t granule) const { return marks_[granule] != 0; }

  /// Calls `visit(granule)` for every one that is marked among so many, in their order.
  template <class Visit>
  void for_each(std::uint32_t granules, Visit&& visit) {
    for (std::uint32_t first = 0; first < granules; first += kGroup) {
      std::uint8_t& group = groups_[first / kGroup];
      if (group == 0) continue;
      bool any = false;
      for (std::uint32_t granule = first; granule < std::min(first + kGroup, granules); ++granule) {
        if (!marked(granule)) continue;
        any = true;
        visit(granule);
      }
      if (!any) group = 0;  // they were unmarked since
    }
  }

 private:
  static constexpr std::uint32_t kGroup = 64;

  static void grow(StableVector<std::uint8_t>& marks, std::uint64_t size) {
    const std::uint64_t old = marks.size();
    marks.grow(size);
    for (std::uint64_t i = old; i < size; ++i) marks[static_cast<std::uint32_t>(i)] = 0;
  }
  // Returns whether it was not.
  [[gnu::always_inline]] static bool set(std::uint8_t& mark) {
    const std::atomic_ref<std::uint8_t> flag(mark);
    if (flag.load(std::memory_order_relaxed) != 0) return false;
    flag.store(1, std::memory_order_relaxed);
    return true;
  }

  StableVector<std::uint8_t> marks_;
  StableVector<std::uint8_t> groups_;  // of kGroup granules; set where one of them may be
};

}  // namespace sweepgrid
