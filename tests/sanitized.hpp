#pragma once

#include <cstddef>
#include <cstdlib>
#include <string_view>

/// Sanitizers make everything about ten times as slow, so what is played again and again is thinned out there.
namespace sweepgrid::oracle {

#if defined(__SANITIZE_THREAD__)
#define SWEEPGRID_THREAD_SANITIZED 1
#elif defined(__SANITIZE_ADDRESS__)
#define SWEEPGRID_ADDRESS_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define SWEEPGRID_THREAD_SANITIZED 1
#elif __has_feature(address_sanitizer)
#define SWEEPGRID_ADDRESS_SANITIZED 1
#endif
#endif

#ifdef SWEEPGRID_THREAD_SANITIZED
inline constexpr bool kThreadSanitized = true;
#else
inline constexpr bool kThreadSanitized = false;
#endif

#ifdef SWEEPGRID_ADDRESS_SANITIZED
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = kThreadSanitized;
#endif

/// Whether everything is played: where SWEEPGRID_LONG is set, as by tools/check --nightly. Else a part of what is
/// played again and again, chosen such that every kind of cell, type, dimension, reduction and number of threads is in
/// it.
inline bool plays_all() { return std::getenv("SWEEPGRID_LONG") != nullptr; }

/// Where a regime begins to count, so that each plays another part.
inline std::size_t first_turn(std::string_view regime) {
  std::size_t sum = 0;
  for (const char letter : regime) sum += static_cast<unsigned char>(letter);
  return plays_all() ? 0 : sum;
}

}  // namespace sweepgrid::oracle
