#pragma once

#include <cstdint>
#include <random>

namespace sweepgrid {

/// Random numbers that are the same on every machine: std::mt19937_64, whose output the standard fixes, and conversions
/// of our own, because those of the standard library differ between implementations.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) : engine_(seed) {}

  /// In [0, 1): the upper 53 bits of the next number, times 2^-53.
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

  /// In [low, high).
  double between(double low, double high) { return low + unit() * (high - low); }

  /// In [0, count), count < 2^53: the integer part of unit() * count.
  std::uint64_t below(std::uint64_t count) { return static_cast<std::uint64_t>(unit() * static_cast<double>(count)); }

  /// Nearly normal, mean 0, deviation 1, within -6..6: the sum of twelve unit() less 6. No libm, so it is exact.
  double bell() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += unit();
    return sum;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace sweepgrid
