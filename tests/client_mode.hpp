#pragma once

#include <cfenv>
#include <cstdint>
#include <limits>
#include <vector>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace sweepgrid::oracle {

/// The register that says how the calling thread computes, without the flags of exceptions that were raised.
inline std::uint64_t mode_register() {
#if defined(__x86_64__)
  return _mm_getcsr() & ~0x3fU;
#elif defined(__aarch64__)
  std::uint64_t now;
  asm volatile("mrs %0, fpcr" : "=r"(now) : : "memory");
  return now;
#else
  return static_cast<std::uint64_t>(std::fegetround());
#endif
}

inline void set_mode_register(std::uint64_t mode) {
#if defined(__x86_64__)
  _mm_setcsr(static_cast<unsigned>(mode));
#elif defined(__aarch64__)
  asm volatile("msr fpcr, %0" : : "r"(mode) : "memory");
#else
  std::fesetround(static_cast<int>(mode));
#endif
}

/// Gives the calling thread a mode that a client may have, while it lives.
class ClientMode {
 public:
  struct Kind {
    bool flush = false;  ///< denormals become zero, read ones too: what linking with -ffast-math does
    int rounding = FE_TONEAREST;
  };

  explicit ClientMode(Kind kind) : rounding_(std::fegetround()), before_(mode_register()) {
    std::fesetround(kind.rounding);
#if defined(__x86_64__)
    if (kind.flush) set_mode_register(mode_register() | 0x8040);
#elif defined(__aarch64__)
    if (kind.flush) set_mode_register(mode_register() | std::uint64_t{1} << 24);
#endif
  }
  ~ClientMode() {
    std::fesetround(rounding_);
    set_mode_register(before_);
  }
  ClientMode(const ClientMode&) = delete;
  ClientMode& operator=(const ClientMode&) = delete;

  static std::vector<Kind> kinds() {
    std::vector<Kind> kinds;
    for (const int rounding : {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
      kinds.push_back({false, rounding});
      kinds.push_back({true, rounding});
    }
    return kinds;
  }

 private:
  int rounding_;
  std::uint64_t before_;
};

/// Whether the calling thread computes in the standard mode, judged by results.
inline bool computes_as_standard() {
  volatile double one = 1;
  volatile double little = 0x1p-60;
  const bool nearest = one + little == 1 && -one - little == -1 && one - little == 1;
  volatile float denormal = std::numeric_limits<float>::denorm_min();
  volatile float twice = denormal + denormal;
  volatile float least = std::numeric_limits<float>::min();
  volatile float half = least / 2;
  return nearest && twice > denormal && half > 0;
}

}  // namespace sweepgrid::oracle
