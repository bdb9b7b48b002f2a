#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "sap_oracle.hpp"

/// Random op scripts for one cell: what moves how, and on which coordinates.
namespace sweepgrid::oracle {

/// The same numbers with every standard library, unlike the distributions of <random>.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  int below(int bound) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(bound)); }
  int between(int low, int high) { return low + below(high - low + 1); }
  bool percent(int share) { return below(100) < share; }

 private:
  std::mt19937_64 engine_;
};

/// Which coordinates a script uses.
enum class Palette {
  kFine,      ///< 20 000 values: ties are rare
  kLattice,   ///< 12 values: nearly everything ties
  kExtremes,  ///< infinities, largest and smallest values, denormals, both zeros
  kFar,       ///< neighbouring values round 1e30; integers near their largest
};

enum class Shape { kMixed, kThin, kOneOverAll, kIdentical };
enum class Motion { kStay, kJitter, kFastLeft, kFastRight, kTeleport, kResize, kAny };

/// How a script behaves.
struct Regime {
  const char* name;
  Palette palette = Palette::kFine;
  Shape shape = Shape::kMixed;
  Motion motion = Motion::kAny;
  int population = 100;
  int moving_percent = 100;
  int churn_percent = 0;        ///< residents erased per drain; others come in for them at once
  bool all_or_nothing = false;  ///< drains erase all and insert all by turns
  int drains = 16;
};

/// The coordinates of a palette in ascending order; -0.0 and 0.0 stand for the same place.
template <class Scalar>
std::vector<Scalar> coordinates(Palette palette) {
  using Limits = std::numeric_limits<Scalar>;
  std::vector<Scalar> values;
  if (palette == Palette::kLattice) {
    for (int index = -6; index < 6; ++index) values.push_back(static_cast<Scalar>(index));
  } else if (palette == Palette::kFine) {
    for (int index = -10'000; index < 10'000; ++index) {
      values.push_back(static_cast<Scalar>(std::floating_point<Scalar> ? index * 0.37 : index));
    }
  } else if constexpr (std::floating_point<Scalar>) {
    if (palette == Palette::kFar) {
      values.push_back(static_cast<Scalar>(1e30));
      while (values.size() < 200) values.push_back(std::nextafter(values.back(), Limits::infinity()));
    } else {
      const Scalar tiny = Limits::denorm_min();
      values = {-Limits::infinity(),
                Limits::lowest(),
                Scalar(-1e30),
                -1,
                -Limits::min(),
                -3 * tiny,
                -tiny,
                Scalar(-0.0),
                Scalar(0),
                -0.0,
                tiny,
                3 * tiny,
                Limits::min(),
                1,
                Scalar(1e30),
                Limits::max(),
                Limits::infinity()};
    }
  } else if (palette == Palette::kFar) {
    for (int index = 199; index >= 0; --index) values.push_back(static_cast<Scalar>(Limits::max() - index));
  } else {
    for (const int index : {0, 1, 2}) values.push_back(static_cast<Scalar>(Limits::min() + index));
    for (const int index : {-1, 0, 1}) values.push_back(static_cast<Scalar>(index));
    for (const int index : {2, 1, 0}) values.push_back(static_cast<Scalar>(Limits::max() - index));
  }
  // Negative numbers wrap round where the scalar is unsigned.
  if constexpr (std::unsigned_integral<Scalar>) std::sort(values.begin(), values.end());
  return values;
}

/// Writes random ops, drain by drain; the same for the same regime and seed. Boxes live on the indices of the palette.
template <class Scalar, int Dim>
class OpScript {
 public:
  OpScript(const Regime& regime, std::uint64_t seed)
      : regime_(regime), random_(seed), values_(coordinates<Scalar>(regime.palette)) {
    // About three overlaps per box, whatever the population.
    const double share = std::pow(3.0 / std::max(4, regime.population), 1.0 / Dim) / 2;
    width_ = std::max(1, static_cast<int>(share * last()));
  }

  Drain<Scalar, Dim> next() {
    Drain<Scalar, Dim> ops;
    std::vector<ObjectId> freed;
    const bool erase_all = regime_.all_or_nothing && !spans_.empty();
    for (auto entry = spans_.begin(); entry != spans_.end();) {
      if (erase_all || random_.percent(regime_.churn_percent)) {
        ops.push_back({entry->first, OpKind::kErase, {}});
        freed.push_back(entry->first);
        entry = spans_.erase(entry);
        continue;
      }
      if (random_.percent(regime_.moving_percent)) {
        move(entry->second);
        ops.push_back({entry->first, OpKind::kUpdate, box(entry->second)});
      }
      ++entry;
    }
    if (!erase_all) insert(ops);
    // Freed ids come back first, but not in the drain that erases them.
    free_.insert(free_.end(), freed.begin(), freed.end());
    for (std::size_t index = ops.size(); index > 1; --index) {
      std::swap(ops[index - 1], ops[static_cast<std::size_t>(random_.below(static_cast<int>(index)))]);
    }
    return ops;
  }

 private:
  struct Span {
    std::array<int, Dim> low;
    std::array<int, Dim> high;
  };

  [[nodiscard]] int last() const { return static_cast<int>(values_.size()) - 1; }

  void insert(Drain<Scalar, Dim>& ops) {
    int missing = regime_.population - static_cast<int>(spans_.size());
    // Half of them in the first drain, so that the second inserts among residents.
    if (next_id_ == 0 && !regime_.all_or_nothing) missing = (missing + 1) / 2;
    for (; missing > 0; --missing) {
      ObjectId object;
      if (!free_.empty()) {
        object = free_.back();
        free_.pop_back();
      } else {
        object = next_id_ % 2 == 0 ? next_id_ : kNoObject - next_id_;
        ++next_id_;
      }
      const Span span = spans_.empty() && regime_.shape == Shape::kOneOverAll ? everything() : anywhere();
      spans_.emplace(object, span);
      ops.push_back({object, OpKind::kInsert, box(span)});
    }
  }

  [[nodiscard]] Span everything() const {
    Span span;
    span.low.fill(0);
    span.high.fill(last());
    return span;
  }

  Span anywhere() {
    Span span;
    for (int axis = 0; axis < Dim; ++axis) {
      int width = random_.between(0, std::min(2 * width_, last()));
      if (regime_.shape == Shape::kThin && random_.percent(60)) width = 0;
      if (regime_.shape == Shape::kIdentical) width = width_;
      span.low[axis] = regime_.shape == Shape::kIdentical ? random_.below(2) * (last() - width) / 2
                                                          : random_.between(0, last() - width);
      span.high[axis] = span.low[axis] + width;
    }
    return span;
  }

  void move(Span& span) {
    Motion motion = regime_.motion;
    if (motion == Motion::kAny) motion = static_cast<Motion>(random_.below(static_cast<int>(Motion::kAny)));
    if (motion == Motion::kStay) return;
    if (motion == Motion::kTeleport || regime_.shape == Shape::kIdentical) {
      span = anywhere();
      return;
    }
    for (int axis = 0; axis < Dim; ++axis) {
      if (motion == Motion::kResize) {
        int& low = span.low[axis];
        int& high = span.high[axis];
        low = std::clamp(low + random_.between(-width_, width_), 0, last());
        high = std::clamp(high + random_.between(-width_, width_), 0, last());
        if (low > high) std::swap(low, high);
        if (regime_.shape == Shape::kThin && random_.percent(60)) high = low;
      } else {
        const int own = span.high[axis] - span.low[axis] + 1;
        const int jitter = random_.between(-width_ / 4 - 1, width_ / 4 + 1);
        const int fast = own * random_.between(2, 6);
        shift(span, axis, motion == Motion::kFastLeft ? -fast : motion == Motion::kFastRight ? fast : jitter);
      }
    }
  }

  /// A box that would leave on one side comes in at the other.
  void shift(Span& span, int axis, int by) const {
    const int width = span.high[axis] - span.low[axis];
    int low = span.low[axis] + by;
    if (low < 0) low = last() - width;
    if (low + width > last()) low = 0;
    span.low[axis] = low;
    span.high[axis] = low + width;
  }

  [[nodiscard]] Box<Scalar, Dim> box(const Span& span) const {
    Box<Scalar, Dim> box;
    for (int axis = 0; axis < Dim; ++axis) {
      box.min[axis] = values_[static_cast<std::size_t>(span.low[axis])];
      box.max[axis] = values_[static_cast<std::size_t>(span.high[axis])];
    }
    return box;
  }

  Regime regime_;
  Random random_;
  std::vector<Scalar> values_;
  int width_ = 1;  // half the mean width of boxes, in indices
  std::map<ObjectId, Span> spans_;
  std::vector<ObjectId> free_;
  std::uint32_t next_id_ = 0;
};

/// One regime for each thing that has broken a sweep and prune somewhere.
inline constexpr std::array kRegimes{
    Regime{.name = "Empty", .population = 0, .drains = 3},
    Regime{.name = "Alone", .population = 1, .churn_percent = 20, .drains = 20},
    Regime{.name = "TwoBoxes", .palette = Palette::kLattice, .population = 2, .churn_percent = 20, .drains = 60},
    Regime{.name = "TenOnLattice", .palette = Palette::kLattice, .population = 10, .churn_percent = 10, .drains = 40},
    Regime{.name = "Ties", .palette = Palette::kLattice, .churn_percent = 5},
    Regime{.name = "TiesFewMove", .palette = Palette::kLattice, .moving_percent = 4, .drains = 30},
    Regime{.name = "Thin", .palette = Palette::kLattice, .shape = Shape::kThin, .churn_percent = 5},
    Regime{.name = "ThinFewMove", .shape = Shape::kThin, .moving_percent = 5, .drains = 30},
    Regime{.name = "Extremes", .palette = Palette::kExtremes, .population = 40, .churn_percent = 10, .drains = 24},
    Regime{
        .name = "ExtremesFewMove", .palette = Palette::kExtremes, .population = 40, .moving_percent = 8, .drains = 30},
    Regime{.name = "Far", .palette = Palette::kFar, .churn_percent = 5},
    Regime{.name = "FarFewMove", .palette = Palette::kFar, .moving_percent = 5, .drains = 30},
    Regime{.name = "Identical", .shape = Shape::kIdentical, .population = 40, .moving_percent = 30, .churn_percent = 5},
    Regime{.name = "OneOverAll", .shape = Shape::kOneOverAll, .moving_percent = 10, .churn_percent = 2, .drains = 30},
    Regime{.name = "JitterFew", .motion = Motion::kJitter, .moving_percent = 5, .drains = 40},
    Regime{.name = "JitterAll", .motion = Motion::kJitter},
    Regime{.name = "TeleportFew", .motion = Motion::kTeleport, .moving_percent = 5, .drains = 40},
    Regime{.name = "TeleportAll", .motion = Motion::kTeleport},
    Regime{.name = "FastLeftFew", .motion = Motion::kFastLeft, .moving_percent = 5, .drains = 40},
    Regime{.name = "FastLeftAll", .motion = Motion::kFastLeft},
    Regime{.name = "FastRightFew", .motion = Motion::kFastRight, .moving_percent = 5, .drains = 40},
    Regime{.name = "FastRightAll", .motion = Motion::kFastRight},
    Regime{.name = "ResizeFew", .motion = Motion::kResize, .moving_percent = 5, .drains = 40},
    Regime{.name = "ResizeAll", .motion = Motion::kResize},
    Regime{.name = "ChurnLow", .moving_percent = 0, .churn_percent = 2, .drains = 40},
    Regime{.name = "ChurnHalf", .moving_percent = 50, .churn_percent = 50},
    Regime{.name = "ChurnAll", .palette = Palette::kLattice, .churn_percent = 100},
    Regime{.name = "AllOrNothing", .palette = Palette::kLattice, .all_or_nothing = true},
    Regime{.name = "ManyFewMove", .population = 400, .moving_percent = 2, .churn_percent = 1, .drains = 16},
    Regime{.name = "ManyAllMove", .population = 400, .drains = 5},
    Regime{.name = "ManyChurn", .population = 400, .moving_percent = 10, .churn_percent = 10, .drains = 8},
};

}  // namespace sweepgrid::oracle
