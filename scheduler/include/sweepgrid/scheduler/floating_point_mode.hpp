#pragma once

#include <cstdint>

#if !defined(__x86_64__) && !defined(__aarch64__)
#include <cfenv>
#endif

namespace sweepgrid {

/// While one lives, its thread rounds to nearest, keeps denormal numbers and traps no floating-point exception; after
/// that its mode is again what it was. Clients change the mode: a program that is linked with -ffast-math flushes
/// denormals to zero, and oneTBB hands the mode of one thread on to others.
///
/// One is held around each task, bulk share and query, where it costs two reads of a register, and two writes where
/// the mode is another. That is too much for each object: what is called for one object does without, by bits.
class [[nodiscard]] FloatingPointMode {
 public:
  FloatingPointMode() noexcept;
  ~FloatingPointMode();
  FloatingPointMode(const FloatingPointMode&) = delete;
  FloatingPointMode& operator=(const FloatingPointMode&) = delete;

 private:
#if defined(__x86_64__) || defined(__aarch64__)
  std::uint64_t before_;
#else
  std::fenv_t before_;
#endif
};

}  // namespace sweepgrid
