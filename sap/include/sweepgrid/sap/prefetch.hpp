#pragma once

#include <cstddef>

namespace sweepgrid {

/// Asks for the cache lines of [data, data + bytes). A hint: any address is allowed.
/// Forced inline: g++ 12 takes a function that only prefetches for one without effect, and drops its calls.
[[gnu::always_inline]] inline void prefetch(const void* data, std::size_t bytes) {
  constexpr std::size_t kLine = 64;
  const char* const first = static_cast<const char*>(data);
  for (std::size_t offset = 0; offset < bytes; offset += kLine) __builtin_prefetch(first + offset, 1);
}

}  // namespace sweepgrid
