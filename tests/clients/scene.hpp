#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

#include <sweepgrid/engine/engine.hpp>

/// Generated scenes whose boxes are known as integers too: what overlaps is found by these, and the boxes are the same
/// whatever the flags that this is compiled with and the mode of the thread.
namespace clients {

/// SplitMix64: the same numbers everywhere, other than with the distributions of the standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31);
  }
  /// In [0, end).
  std::int64_t below(std::int64_t end) { return static_cast<std::int64_t>(next() % static_cast<std::uint64_t>(end)); }

 private:
  std::uint64_t state_;
};

/// What an integer stands for.
enum class Unit {
  kQuarter,   ///< 0.25; of integers 1
  kDenormal,  ///< the least denormal number; integers have none, so 1
};

template <class Scalar>
Scalar scalar(std::int64_t steps, Unit unit) {
  if constexpr (std::floating_point<Scalar>) {
    using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;
    if (unit == Unit::kDenormal) {
      constexpr Bits kSign = Bits{1} << (8 * sizeof(Bits) - 1);
      return std::bit_cast<Scalar>(steps < 0 ? static_cast<Bits>(-steps) | kSign : static_cast<Bits>(steps));
    }
    return static_cast<Scalar>(steps) * Scalar{0.25};
  } else {
    return static_cast<Scalar>(steps);
  }
}

struct Regime {
  const char* name;
  std::int64_t world = 400;  ///< steps on each axis, around zero
  std::int64_t widest = 24;
  Unit unit = Unit::kQuarter;
  int objects = 150;
  int steps = 20;
  bool giants = false;  ///< some reach over everything, to infinity where the type has it
};

template <class Scalar, int Dim>
class Scene {
 public:
  using Box = sweepgrid::Box<Scalar, Dim>;
  using Pairs = std::vector<std::pair<std::uint64_t, std::uint64_t>>;
  struct Steps {
    std::array<std::int64_t, Dim> min, max;
  };

  explicit Scene(const Regime& regime, std::uint64_t seed) : regime_(regime), random_(seed) {}

  /// A box somewhere.
  Steps place() {
    Steps steps;
    const bool giant = regime_.giants && random_.below(20) == 0;
    for (int axis = 0; axis < Dim; ++axis) {
      steps.min[axis] =
          giant && random_.below(2) == 0 ? kEverywhere.min : random_.below(regime_.world) - regime_.world / 2;
      steps.max[axis] = steps.min[axis] + random_.below(regime_.widest);
      if (giant && random_.below(2) == 0) steps.max[axis] = kEverywhere.max;
    }
    return steps;
  }

  /// A box not far from one.
  Steps near(Steps steps) {
    for (int axis = 0; axis < Dim; ++axis) {
      const std::int64_t by = random_.below(9) - 4;
      if (steps.min[axis] != kEverywhere.min) steps.min[axis] += by;
      if (steps.max[axis] != kEverywhere.max) steps.max[axis] += by;
      if (steps.max[axis] < steps.min[axis]) steps.max[axis] = steps.min[axis];
    }
    return steps;
  }

  Box box(const Steps& steps) const {
    Box box;
    for (int axis = 0; axis < Dim; ++axis) {
      box.min[axis] = steps.min[axis] == kEverywhere.min ? kLeast : scalar<Scalar>(steps.min[axis], regime_.unit);
      box.max[axis] = steps.max[axis] == kEverywhere.max ? kMost : scalar<Scalar>(steps.max[axis], regime_.unit);
    }
    return box;
  }

  Random& random() { return random_; }
  const Regime& regime() const { return regime_; }

  /// Who is where, by key.
  std::map<std::uint64_t, Steps> objects;

  /// Pairs that overlap, sorted.
  Pairs pairs() const {
    std::vector<std::pair<std::uint64_t, Steps>> sorted(objects.begin(), objects.end());
    std::sort(sorted.begin(), sorted.end(),
              [](const auto& a, const auto& b) { return a.second.min[0] < b.second.min[0]; });
    Pairs pairs;
    for (auto a = sorted.begin(); a != sorted.end(); ++a) {
      for (auto b = std::next(a); b != sorted.end() && b->second.min[0] <= a->second.max[0]; ++b) {
        bool overlap = true;
        for (int axis = 0; axis < Dim; ++axis) {
          overlap = overlap && a->second.min[axis] <= b->second.max[axis] && b->second.min[axis] <= a->second.max[axis];
        }
        if (overlap) pairs.push_back(std::minmax(a->first, b->first));
      }
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  }

 private:
  static constexpr struct { std::int64_t min = -1'000'000, max = 1'000'000; } kEverywhere{};
  using Limits = std::numeric_limits<Scalar>;
  static constexpr Scalar kMost = Limits::has_infinity ? Limits::infinity() : Limits::max();
  static constexpr Scalar kLeast = Limits::has_infinity ? -Limits::infinity() : Limits::min();

  Regime regime_;
  Random random_;
};

/// FNV-1a over 64-bit words.
class Digest {
 public:
  void add(std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte) value_ = (value_ ^ (word >> (8 * byte) & 0xff)) * 0x100000001b3U;
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

}  // namespace clients
