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

/// When a condition that holds at one instant only changes: where `above` stands to `above` + `below` as t stands to 1.
/// Both are differences of two endpoints, kept as such: exactly a - b.
struct Root {
  struct Difference {
    double a, b;

    [[nodiscard]] double rounded() const { return a - b; }
    [[nodiscard]] Rational exact() const { return Rational(a) - Rational(b); }
  };
  Difference above, below;  // >= 0, not both 0
};

// Whether a <= b. Every rounded operation is on numbers of one sign, so relative errors add up to less than 8 * 2^-53.
bool not_after(const Root& a, const Root& b) {
  const double a_above = a.above.rounded();
  const double b_above = b.above.rounded();
  const double left = a_above * (b_above + b.below.rounded());
  const double right = b_above * (a_above + a.below.rounded());
  constexpr double kBound = 1 + 0x1p-49;
  constexpr double kLeast = 1e-290;  // below, products may have lost digits
  if (left < kInfinity && right < kInfinity && std::max(left, right) > kLeast) {
    if (left * kBound < right) return true;
    if (right * kBound < left) return false;
  }
  const Rational a_exact = a.above.exact();
  const Rational b_exact = b.above.exact();
  return a_exact * (b_exact + b.below.exact()) <= b_exact * (a_exact + a.below.exact());
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
