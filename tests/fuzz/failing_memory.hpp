#pragma once

#include <cstdint>

namespace sweepgrid::fuzz {

/// While one lives, its thread's allocations by operator new are numbered from 0, and some of them fail. Programs that
/// use it link failing_memory.cpp, which replaces operator new. At most one at a time.
class FailingMemory {
 public:
  /// Those from number `first` on fail, `count` of them; 0: none.
  FailingMemory(std::uint64_t first, std::uint64_t count);
  ~FailingMemory();
  FailingMemory(const FailingMemory&) = delete;
  FailingMemory& operator=(const FailingMemory&) = delete;

  /// How many have failed so far.
  [[nodiscard]] std::uint64_t failed() const;

  /// A step that may fail like an allocation, for functions of the client's that throw.
  static void may_fail();
};

}  // namespace sweepgrid::fuzz
