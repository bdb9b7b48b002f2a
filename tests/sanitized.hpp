#pragma once

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

}  // namespace sweepgrid::oracle
