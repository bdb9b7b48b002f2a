#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace sweepgrid {

/// How far an object goes in a step, as its margin follows it: the largest displacement of late that was not alone. A
/// displacement counts for no more than the one before it, so an object that jumps once is no faster than it was. One
/// that moves evenly has its speed from the second displacement on.
///
/// Steps are counted modulo 2^32: an object that rests for so long may be taken for one that has just moved.
class ObjectSpeed {
 public:
  /// Steps for which a displacement can confirm a later one, and which may lie between them without any.
  static constexpr std::uint32_t kRemembered = 8;

  /// What a displacement still counts for after a step: seven eighths, or nearly so, after `stride` of them.
  [[nodiscard]] static double fade_of(int stride) { return 1 - 1 / (8.0 * stride); }

  /// The object appears before `step`. Nothing is known of it, so its first displacement counts by itself.
  void appear(std::uint32_t step) {
    speed_ = 0;
    latest_ = std::numeric_limits<double>::infinity();
    step_ = step;
  }

  /// The object goes by `displacement` before `step`. Several for one step count as the farthest of them.
  void note(double displacement, std::uint32_t step, double fade) {
    const std::uint32_t passed = step - step_;
    if (displacement <= 0) return;  // as if nothing had been said
    if (passed == 0) {
      latest_ = std::max(latest_, displacement);
      return;
    }
    const double earlier = passed <= kRemembered ? latest_ : 0;
    speed_ = std::max(faded(speed_, passed, fade), std::min(earlier, displacement));
    latest_ = displacement;
    step_ = step;
  }

  [[nodiscard]] double at(std::uint32_t step, double fade) const { return faded(speed_, step - step_, fade); }

 private:
  // By squaring and without std::pow(), which is not the same on every machine.
  [[nodiscard]] static double faded(double value, std::uint32_t steps, double fade) {
    for (; steps != 0; steps /= 2, fade *= fade) {
      if (steps % 2 != 0) value *= fade;
    }
    return value;
  }

  // Not initialised, so that memory for many is not touched.
  double speed_;
  double latest_;       // displacement, of the step in which it was made
  std::uint32_t step_;  // of the latest displacement
};

}  // namespace sweepgrid
