#include <sweepgrid/scheduler/floating_point_mode.hpp>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace sweepgrid {

#if defined(__x86_64__)
namespace {

constexpr std::uint64_t kFlags = 0x3f;       // of exceptions that were raised: no part of the mode
constexpr std::uint64_t kStandard = 0x1f80;  // nearest, no flushing, all exceptions masked

}  // namespace

FloatingPointMode::FloatingPointMode() noexcept : before_(_mm_getcsr()) {
  if ((before_ & ~kFlags) != kStandard) _mm_setcsr(kStandard);
}

FloatingPointMode::~FloatingPointMode() {
  if ((before_ & ~kFlags) != kStandard) _mm_setcsr(static_cast<unsigned>(before_));
}

#elif defined(__aarch64__)
namespace {

constexpr std::uint64_t kStandard = 0;

void set_mode(std::uint64_t mode) { asm volatile("msr fpcr, %0" : : "r"(mode) : "memory"); }

std::uint64_t mode() {
  std::uint64_t now;
  asm volatile("mrs %0, fpcr" : "=r"(now) : : "memory");
  return now;
}

}  // namespace

FloatingPointMode::FloatingPointMode() noexcept : before_(mode()) {
  if (before_ != kStandard) set_mode(kStandard);
}

FloatingPointMode::~FloatingPointMode() {
  if (before_ != kStandard) set_mode(before_);
}

#else

FloatingPointMode::FloatingPointMode() noexcept {
  std::fegetenv(&before_);
  std::fesetenv(FE_DFL_ENV);
}

FloatingPointMode::~FloatingPointMode() { std::fesetenv(&before_); }

#endif

}  // namespace sweepgrid
