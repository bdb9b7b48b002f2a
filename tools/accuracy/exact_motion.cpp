#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <boost/multiprecision/cpp_int.hpp>

#include "accuracy/exact_tests.hpp"

namespace sweepgrid::accuracy {
namespace {

using Rational = boost::multiprecision::cpp_rational;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The condition low(t) <= high(t) of two endpoints that move linearly, t from 0 to 1.
struct Condition {
  double low_before, high_before;
  double low_after, high_after;

  [[nodiscard]] bool before() const { return low_before <= high_before; }
  [[nodiscard]] bool after() const { return low_after <= high_after; }
  [[nodiscard]] bool finite() const {
    return std::isfinite(low_before) && std::isfinite(high_before) && std::isfinite(low_after) &&
           std::isfinite(high_after);
  }
  /// Between the instants, when it is not finite: it then holds all the time or never.
  [[nodiscard]] bool between() const {
    if (low_before == -kInfinity || low_after == -kInfinity) return true;
    if (high_before == kInfinity || high_after == kInfinity) return true;
    return false;  // a low at +infinity, or a high at -infinity, and the other endpoint is finite or meets it nowhere
  }
};

/// a - b, kept as such.
struct Difference {
  double a, b;

  [[nodiscard]] double rounded() const { return a - b; }
  [[nodiscard]] Rational exact() const { return Rational(a) - Rational(b); }

  /// Whether rounded() is a - b: the error of a difference is a double, and found by the differences the other way.
  [[nodiscard]] bool is_exact() const {
    const double difference = a - b;
    const double minus_b = difference - a;
    return (a - (difference - minus_b)) - (b + minus_b) == 0;
  }
};

/// When a condition that holds at one instant only changes: where `above` stands to `above` + `below` as t stands to 1.
/// Both are at least 0, and not both 0.
struct Root {
  Difference above, below;

  [[nodiscard]] bool is_exact() const { return above.is_exact() && below.is_exact(); }
};

// Whether x * y, which is `product` when rounded, has lost nothing but digits behind its last.
bool in_range(double x, double y, double product) {
  constexpr double kLeast = 1e-250;
  return product == 0 ? x == 0 || y == 0 : product > kLeast && product < kInfinity;
}

// Whether a <= b, that is a.above / (a.above + a.below) <= b.above / (b.above + b.below): cross-multiplied, all but two
// products cancel out.
bool not_after(const Root& a, const Root& b) {
  const double a_above = a.above.rounded();
  const double a_below = a.below.rounded();
  const double b_above = b.above.rounded();
  const double b_below = b.below.rounded();
  const double left = a_above * b_below;
  const double right = b_above * a_below;
  if (in_range(a_above, b_below, left) && in_range(b_above, a_below, right)) {
    // Three roundings on either side.
    constexpr double kBound = 1 + 0x1p-49;
    if (left * kBound < right) return true;
    if (right * kBound < left) return false;
    if (a.is_exact() && b.is_exact()) {
      // Rounding keeps order, and what two equal products have lost is a double.
      if (left != right) return left < right;
      return std::fma(a_above, b_below, -left) <= std::fma(b_above, a_below, -right);
    }
  }
  return a.above.exact() * b.below.exact() <= b.above.exact() * a.below.exact();
}

// Of two roots the later one, or the earlier one.
const Root& later(const Root& a, const Root& b) { return not_after(a, b) ? b : a; }
const Root& earlier(const Root& a, const Root& b) { return not_after(a, b) ? a : b; }

}  // namespace

bool meet_in_motion(const MovingBox& a, const MovingBox& b) {
  if (a.before.overlaps(b.before) || a.after.overlaps(b.after)) return true;
  // Strictly between the instants, as neither of them will do.
  Root begin{{0, 0}, {1, 0}};  // t = 0
  Root end{{1, 0}, {0, 0}};    // t = 1
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::array<Condition, 2> conditions = {
        {{a.before.min[axis], b.before.max[axis], a.after.min[axis], b.after.max[axis]},
         {b.before.min[axis], a.before.max[axis], b.after.min[axis], a.after.max[axis]}}};
    for (const Condition& condition : conditions) {
      if (!condition.finite()) {
        if (!condition.between()) return false;
        continue;
      }
      const bool before = condition.before();
      const bool after = condition.after();
      if (!before && !after) return false;  // linear: not in between, either
      if (before && after) continue;
      if (before) {
        end =
            earlier(end, {{condition.high_before, condition.low_before}, {condition.low_after, condition.high_after}});
      } else {
        begin =
            later(begin, {{condition.low_before, condition.high_before}, {condition.high_after, condition.low_after}});
      }
    }
  }
  // An end at t = 0 or a begin at t = 1 is no time in between.
  if (end.above.a == end.above.b || begin.below.a == begin.below.b) return false;
  return not_after(begin, end);
}

}  // namespace sweepgrid::accuracy
