#pragma once

#include <cstddef>

namespace sweepgrid {

/// Asks for the cache line at `data`. A hint: any address is allowed.
///
/// The empty statement is there for g++ 12, which takes a function that only prefetches for one without effect, and
/// drops all calls of it, also those of lambdas into which it was inlined.
[[gnu::always_inline]] inline void prefetch(const void* data) {
  __builtin_prefetch(data, 1);
  asm volatile("");
}

/// The same for the lines of [data, data + bytes).
[[gnu::always_inline]] inline void prefetch(const void* data, std::size_t bytes) {
  constexpr std::size_t kLine = 64;
  const char* const first = static_cast<const char*>(data);
  for (std::size_t offset = 0; offset < bytes; offset += kLine) prefetch(first + offset);
}

}  // namespace sweepgrid
