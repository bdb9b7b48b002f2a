#pragma once

#include <cstdint>

namespace sweepgrid {

/// Exact counts of the work that cells did. The same for every thread count and every machine.
struct SapCounters {
  std::uint64_t swaps = 0;      ///< exchanges of two neighbouring endpoints
  std::uint64_t box_tests = 0;  ///< overlap tests of two boxes (on all axes, or all but the swapped one)
  std::uint64_t deltas = 0;     ///< overlap deltas written
  /// Endpoints read or moved other than by a swap: by passes over interval lists, and in the segments that an insert,
  /// an erase or its search for overlaps touches.
  std::uint64_t endpoints_visited = 0;
  std::uint64_t endpoints_sorted = 0;  ///< endpoints of inserts and erases that were sorted before they were integrated
  std::uint64_t search_steps = 0;      ///< comparisons of binary searches for the segment of an endpoint
  std::uint64_t local_sorts = 0;       ///< drains that moved only the touched endpoints
  std::uint64_t global_sorts = 0;      ///< drains that passed over whole interval lists
  std::uint64_t segments_split = 0;    ///< full segments cut in two
  std::uint64_t segments_merged = 0;   ///< sparse neighbouring segments joined

  SapCounters& operator+=(const SapCounters& other) {
    swaps += other.swaps;
    box_tests += other.box_tests;
    deltas += other.deltas;
    endpoints_visited += other.endpoints_visited;
    endpoints_sorted += other.endpoints_sorted;
    search_steps += other.search_steps;
    local_sorts += other.local_sorts;
    global_sorts += other.global_sorts;
    segments_split += other.segments_split;
    segments_merged += other.segments_merged;
    return *this;
  }

  friend bool operator==(const SapCounters&, const SapCounters&) = default;
};

}  // namespace sweepgrid
