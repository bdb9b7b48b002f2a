#pragma once

#include <cstdint>

/// The heap of a test program, as operator new sees it: what is held, how often it was asked, and asked in vain.
/// Programs that link watched_heap.cpp have it. oneTBB's own allocations go elsewhere.
namespace sweepgrid::heap {

/// Bytes that are allocated now.
[[nodiscard]] std::int64_t bytes();
/// Allocations until now.
[[nodiscard]] std::int64_t allocations();

/// While it lives, allocations are numbered from 0, and those in [first, first + count) fail. One at a time.
class Failing {
 public:
  static constexpr std::int64_t kAllAfter = std::int64_t{1} << 40;
  /// Whose allocations are numbered and fail.
  enum class Of { kAllThreads, kThisThread };

  Failing(std::int64_t first, std::int64_t count, Of of = Of::kAllThreads);
  ~Failing();
  Failing(const Failing&) = delete;
  Failing& operator=(const Failing&) = delete;

  /// Allocations that failed.
  [[nodiscard]] std::int64_t failed() const;
};

/// A step that may fail like an allocation, for functions of a client's that throw.
void may_fail();

}  // namespace sweepgrid::heap
