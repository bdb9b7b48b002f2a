#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/sap/endpoint.hpp>
#include <sweepgrid/sap/ordered_box.hpp>

#include "client_mode.hpp"
#include "op_script.hpp"

namespace sweepgrid::ordered_box_test {
namespace {

using oracle::Palette;

template <class Scalar>
class OrderedBits : public testing::Test {};

using Scalars = testing::Types<float, double, std::int8_t, std::int16_t, std::int32_t, std::int64_t, std::uint8_t,
                               std::uint16_t, std::uint32_t, std::uint64_t>;
TYPED_TEST_SUITE(OrderedBits, Scalars);

TYPED_TEST(OrderedBits, OrderIsThatOfTheValues) {
  std::vector<TypeParam> values = oracle::coordinates<TypeParam>(Palette::kExtremes);
  values.push_back(0);
  values.push_back(std::numeric_limits<TypeParam>::max() / 3);
  for (const TypeParam a : values) {
    for (const TypeParam b : values) {
      EXPECT_EQ(ordered_bits(a) < ordered_bits(b), a < b) << +a << ' ' << +b;
      EXPECT_EQ(ordered_bits(a) == ordered_bits(b), a == b) << +a << ' ' << +b;
    }
  }
}

TYPED_TEST(OrderedBits, TakesThirtyTwoBitsWhereTheySuffice) {
  EXPECT_EQ(sizeof(ordered_bits(TypeParam{})), sizeof(TypeParam) <= 4 ? 4U : 8U);
}

template <class Scalar>
class OrderedBitsOfReals : public testing::Test {};

using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(OrderedBitsOfReals, Reals);

TYPED_TEST(OrderedBitsOfReals, BothZerosAreOne) {
  EXPECT_EQ(ordered_bits(TypeParam{-0.0}), ordered_bits(TypeParam{0.0}));
  EXPECT_LT(ordered_bits(-std::numeric_limits<TypeParam>::denorm_min()), ordered_bits(TypeParam{-0.0}));
  EXPECT_LT(ordered_bits(TypeParam{-0.0}), ordered_bits(std::numeric_limits<TypeParam>::denorm_min()));
}

TYPED_TEST(OrderedBitsOfReals, NeighboursAreOneApart) {
  for (const double value : {-1e30, -1.5, -1e-30, 1e-30, 0.1, 1.0, 1e30}) {
    const auto real = static_cast<TypeParam>(value);
    const TypeParam next = std::nextafter(real, std::numeric_limits<TypeParam>::infinity());
    EXPECT_EQ(ordered_bits(next) - ordered_bits(real), 1U) << value;
  }
}

TEST(OrderedBox, OverlapsAsTheBoxesDo) {
  oracle::Random random(1);
  for (const Palette palette : {Palette::kLattice, Palette::kExtremes, Palette::kFar}) {
    const std::vector<float> values = oracle::coordinates<float>(palette);
    const auto any_box = [&] {
      Box<float, 3> box;
      for (int axis = 0; axis < 3; ++axis) {
        const auto low = static_cast<std::size_t>(random.below(static_cast<int>(values.size())));
        const auto high = static_cast<std::size_t>(random.below(static_cast<int>(values.size())));
        box.min[axis] = values[std::min(low, high)];
        box.max[axis] = values[std::max(low, high)];
      }
      return box;
    };
    for (int trial = 0; trial < 3000; ++trial) {
      const Box<float, 3> a = any_box();
      const Box<float, 3> b = any_box();
      const OrderedBox<float, 3> x(a);
      const OrderedBox<float, 3> y(b);
      ASSERT_EQ(x.overlaps(y), a.overlaps(b));
      ASSERT_EQ(y.overlaps(x), x.overlaps(y));
      ASSERT_EQ(x == y, a == b);
      for (int skipped = 0; skipped < 3; ++skipped) {
        bool beside = true;
        for (int axis = 0; axis < 3; ++axis) {
          beside &= axis == skipped || (a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis]);
        }
        ASSERT_EQ(x.overlaps_beside(skipped, y), beside);
      }
    }
  }
}

TEST(Box, ANaNOrAnInvertedAxisIsNotValid) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_TRUE((Box<float, 2>({0, 0}, {0, 0}).valid()));
  EXPECT_TRUE((Box<float, 2>({-infinity, 0}, {infinity, -0.0F}).valid()));
  EXPECT_FALSE((Box<float, 2>({0, 1}, {1, 0}).valid()));
  for (int place = 0; place < 4; ++place) {
    Box<float, 2> box({0, 0}, {1, 1});
    (place < 2 ? box.min : box.max)[static_cast<std::size_t>(place % 2)] = nan;
    EXPECT_FALSE(box.valid()) << place;
  }
}

/// Values that are easily taken for others: denormals, zeros, infinities, NaNs.
template <class Real>
std::vector<Real> delicate() {
  using Limits = std::numeric_limits<Real>;
  std::vector<Real> values = {0,
                              Limits::denorm_min(),
                              3 * Limits::denorm_min(),
                              Limits::min() - Limits::denorm_min(),
                              Limits::min(),
                              1,
                              Limits::max(),
                              Limits::infinity(),
                              Limits::quiet_NaN()};
  for (std::size_t i = values.size(); i-- > 0;) values.push_back(-values[i]);
  return values;
}

template <class Real>
void check_comparisons_of_boxes() {
  // What is true of the values, found in the standard mode; a, b and c, d as the ends of two boxes on one axis.
  struct Case {
    Real a, b, c, d;
    bool valid, overlap, equal;
  };
  std::vector<Case> cases;
  const std::vector<Real> values = delicate<Real>();
  for (const Real a : values) {
    for (const Real b : values) {
      for (const Real c : values) {
        for (const Real d : values) {
          if (c <= d) cases.push_back({a, b, c, d, a <= b, a <= b && a <= d && c <= b, a == c && b == d});
        }
      }
    }
  }
  for (const oracle::ClientMode::Kind kind : oracle::ClientMode::kinds()) {
    std::size_t wrong = 0;
    {
      const oracle::ClientMode client(kind);
      for (const Case& c : cases) {
        const Box<Real, 3> box({0, c.a, -1}, {1, c.b, -1});
        const Box<Real, 3> other({0, c.c, -1}, {1, c.d, -1});
        wrong += box.valid() == c.valid ? 0 : 1;
        wrong += (box.valid() && box.overlaps(other)) == c.overlap ? 0 : 1;
        wrong += (box.valid() && box == other) == c.equal ? 0 : 1;
      }
    }
    EXPECT_EQ(wrong, 0U) << kind.flush << ' ' << kind.rounding;
  }
}

TEST(Box, IsComparedByItsBitsInEveryMode) {
  check_comparisons_of_boxes<float>();
  check_comparisons_of_boxes<double>();
}

template <class Real>
struct ForeignBoxOf {
  std::vector<Real> lower;
  std::vector<Real> upper;
  [[nodiscard]] const std::vector<Real>& min() const { return lower; }
  [[nodiscard]] const std::vector<Real>& max() const { return upper; }
};
using ForeignBox = ForeignBoxOf<double>;

TEST(Box, TakesTheCornersOfAnythingLikeABox) {
  const Box<double, 2> box = ForeignBox{{1, 2}, {3, 4}};
  EXPECT_EQ(box, (Box<double, 2>({1, 2}, {3, 4})));
  static_assert(!std::is_constructible_v<Box<float, 2>, int>);
}

template <class To, class From>
inline constexpr bool kTakes = std::is_convertible_v<ForeignBoxOf<From>, Box<To, 2>>;

TEST(Box, TakesNoCornersThatItCannotHold) {
  static_assert(kTakes<double, float> && kTakes<double, std::int32_t> && kTakes<float, std::int16_t>);
  static_assert(kTakes<std::int32_t, std::int16_t> && kTakes<std::int32_t, std::uint16_t>);
  static_assert(!kTakes<std::int16_t, double> && !kTakes<std::int32_t, float> && !kTakes<float, double>);
  static_assert(!kTakes<float, std::int32_t> && !kTakes<double, std::int64_t> && !kTakes<double, long double>);
  static_assert(!kTakes<std::int16_t, std::int32_t> && !kTakes<std::uint32_t, std::int16_t>);
  static_assert(!kTakes<std::int16_t, std::uint16_t> && !kTakes<std::uint16_t, std::int16_t>);
}

template <class Scalar>
class Endpoints : public testing::Test {};

TYPED_TEST_SUITE(Endpoints, Reals);

TYPED_TEST(Endpoints, KeepValueSideAndOwner) {
  using End = Endpoint<TypeParam>;
  for (const Slot owner : {0U, 1U, kMaxSlots - 1}) {
    for (const TypeParam value : oracle::coordinates<TypeParam>(Palette::kExtremes)) {
      const End min = End::min_of(owner, ordered_bits(value));
      const End max = End::max_of(owner, ordered_bits(value));
      EXPECT_EQ(min.value(), ordered_bits(value));
      EXPECT_EQ(max.value(), ordered_bits(value));
      EXPECT_EQ(min.owner(), owner);
      EXPECT_EQ(max.owner(), owner);
      EXPECT_FALSE(min.is_max());
      EXPECT_TRUE(max.is_max());
    }
  }
}

TYPED_TEST(Endpoints, AreOrderedByValueThenMinBeforeMaxThenOwner) {
  using End = Endpoint<TypeParam>;
  const auto low = ordered_bits(TypeParam{1});
  const auto high = ordered_bits(std::nextafter(TypeParam{1}, TypeParam{2}));
  const std::vector<End> ascending{
      End::min_of(2, low),  End::min_of(9, low),  End::max_of(0, low),  End::max_of(9, low),
      End::min_of(0, high), End::min_of(1, high), End::max_of(0, high), End::max_of(kMaxSlots - 1, high)};
  for (std::size_t a = 0; a < ascending.size(); ++a) {
    for (std::size_t b = 0; b < ascending.size(); ++b) {
      EXPECT_EQ(ascending[a] < ascending[b], a < b);
      EXPECT_EQ(ascending[a] == ascending[b], a == b);
    }
  }
}

}  // namespace
}  // namespace sweepgrid::ordered_box_test
