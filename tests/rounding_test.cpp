// Rounding never takes anything from a box, and gives it no more than it must.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include <sweepgrid/sap/rounding.hpp>

#include "client_mode.hpp"

namespace sweepgrid::rounding_test {
namespace {

using Double = std::numeric_limits<double>;
using Float = std::numeric_limits<float>;

using oracle::ClientMode;

std::vector<double> interesting() {
  std::vector<double> values = {0.0,
                                -0.0,
                                Double::denorm_min(),
                                Double::min(),
                                1e-310,
                                1e-300,
                                1e-60,
                                0x1p-149,
                                0x1p-150,
                                0x1.8p-149,
                                0x1.fffffep-127,
                                0x1.ffffffp-127,
                                0x1p-126,
                                0x1.0000001p-126,
                                1,
                                1 + 0x1p-24,
                                1 + 0x1p-25,
                                0.1,
                                1e8 + 0.3,
                                3.4028234663852886e38,
                                3.4028235e38,
                                1e39,
                                Double::max(),
                                Double::infinity()};
  std::mt19937_64 random(7);
  for (int i = 0; i < 20'000; ++i) {
    const double value = std::bit_cast<double>(random());
    if (!std::isnan(value)) values.push_back(std::fabs(value));
    values.push_back(
        std::ldexp(1 + static_cast<double>(random() % 1'000'003) / 1'000'003, static_cast<int>(random() % 320) - 160));
  }
  const std::size_t half = values.size();
  for (std::size_t i = 0; i < half; ++i) values.push_back(-values[i]);
  return values;
}

TEST(Rounding, NeighboursAreThoseOfTheStandardLibrary) {
  for (const double value : interesting()) {
    const auto narrow = static_cast<float>(value);
    EXPECT_EQ(next_above(value), std::nextafter(value, Double::infinity())) << value;
    EXPECT_EQ(next_below(value), std::nextafter(value, -Double::infinity())) << value;
    EXPECT_EQ(next_above(narrow), std::nextafter(narrow, Float::infinity())) << narrow;
    EXPECT_EQ(next_below(narrow), std::nextafter(narrow, -Float::infinity())) << narrow;
  }
}

TEST(Rounding, FloatsAreTheNearestOnTheRightSide) {
  for (const double value : interesting()) {
    const float below = round_below(value);
    const float above = round_above(value);
    EXPECT_LE(below, value) << value;
    EXPECT_GE(above, value) << value;
    if (below != Float::infinity()) {
      EXPECT_GT(std::nextafter(below, Float::infinity()), value) << value;
    }
    if (above != -Float::infinity()) {
      EXPECT_LT(std::nextafter(above, -Float::infinity()), value) << value;
    }
  }
  EXPECT_TRUE(std::isnan(round_below(Double::quiet_NaN())));
  EXPECT_TRUE(std::isnan(round_above(Double::quiet_NaN())));
}

/// Every exponent and sign, with fractions at and beside what floats tell apart, ties, and random ones.
std::vector<double> of_every_exponent() {
  constexpr std::uint64_t kOnes = (std::uint64_t{1} << 52) - 1;
  constexpr std::uint64_t kCut = (std::uint64_t{1} << 29) - 1;
  std::mt19937_64 random(5);
  std::vector<double> values;
  for (std::uint64_t exponent = 0; exponent < 2048; ++exponent) {
    std::vector<std::uint64_t> fractions = {0,
                                            1,
                                            kOnes,
                                            kCut,
                                            kCut + 1,
                                            kCut / 2,
                                            kCut / 2 + 1,
                                            kCut / 2 + 2,
                                            kOnes & ~kCut,
                                            (kOnes & ~kCut) + 1,
                                            kOnes / 2,
                                            kOnes / 2 + 1};
    for (unsigned bits = 0; bits < 52; bits += 4)
      fractions.push_back(random() & kOnes & ~((std::uint64_t{1} << bits) - 1));
    for (const std::uint64_t fraction : fractions) {
      for (const std::uint64_t sign : {0, 1})
        values.push_back(std::bit_cast<double>(sign << 63 | exponent << 52 | fraction));
    }
  }
  return values;
}

/// What round_below() is by definition, in the standard mode. Zero has the sign plus.
float below_by_definition(double value) {
  auto nearest = static_cast<float>(value);
  if (static_cast<double>(nearest) > value) nearest = std::nextafter(nearest, -Float::infinity());
  return nearest == 0 ? 0.0F : nearest;
}

float above_by_definition(double value) { return -below_by_definition(-value); }

std::uint32_t bits_of(float value) { return std::bit_cast<std::uint32_t>(value); }

TEST(Rounding, FloatsAreThoseOfTheDefinitionBitForBitInEveryMode) {
  const std::vector<double> values = of_every_exponent();
  std::vector<std::array<float, 2>> expected;
  for (const double value : values) expected.push_back({below_by_definition(value), above_by_definition(value)});
  for (const ClientMode::Kind kind : ClientMode::kinds()) {
    std::size_t wrong = 0;
    {
      const ClientMode client(kind);
      for (std::size_t i = 0; i < values.size(); ++i) {
        wrong += bits_of(round_below(values[i])) == bits_of(expected[i][0]) ? 0 : 1;
        wrong += bits_of(round_above(values[i])) == bits_of(expected[i][1]) ? 0 : 1;
      }
    }
    EXPECT_EQ(wrong, 0U) << kind.flush << ' ' << kind.rounding;
  }
}

/// What round_outward() is by definition, in the standard mode.
template <int Dim>
Box<float, Dim> outward_by_definition(const Box<double, Dim>& box) {
  Box<float, Dim> result;
  for (int axis = 0; axis < Dim; ++axis) {
    const bool valid = box.min[axis] <= box.max[axis];
    result.min[axis] = valid ? below_by_definition(box.min[axis]) : above_by_definition(box.min[axis]);
    result.max[axis] = valid ? above_by_definition(box.max[axis]) : below_by_definition(box.max[axis]);
  }
  return result;
}

template <int Dim>
void check_boxes() {
  const std::vector<double> values = of_every_exponent();
  std::mt19937_64 random(Dim);
  std::vector<Box<double, Dim>> boxes;
  std::vector<Box<float, Dim>> expected;
  for (int i = 0; i < 30'000; ++i) {
    Box<double, Dim> box;
    for (int axis = 0; axis < Dim; ++axis) {
      // One box in three is made of common numbers alone; others have odd ones among them.
      const auto number = [&] {
        if (i % 3 != 0 && random() % 4 == 0) return values[random() % values.size()];
        return random() % 8 == 0 ? 0.0 : (static_cast<double>(random() >> 11) * 0x1p-53 - 0.5) * 1000;
      };
      box.min[axis] = number();
      box.max[axis] = i % 5 == 0 ? box.min[axis] : number();
      if (i % 7 != 0 && box.max[axis] < box.min[axis]) std::swap(box.min[axis], box.max[axis]);
    }
    boxes.push_back(box);
    expected.push_back(outward_by_definition(box));
  }
  for (const ClientMode::Kind kind : ClientMode::kinds()) {
    std::size_t wrong = 0;
    {
      const ClientMode client(kind);
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        const Box<float, Dim> rounded = round_outward<float>(boxes[i]);
        wrong += std::memcmp(&rounded, &expected[i], sizeof(rounded)) == 0 ? 0 : 1;
      }
    }
    EXPECT_EQ(wrong, 0U) << Dim << " axes, " << kind.flush << ' ' << kind.rounding;
  }
}

TEST(Rounding, BoxesAreThoseOfTheDefinitionBitForBitInEveryMode) {
  check_boxes<1>();
  check_boxes<2>();
  check_boxes<3>();
  check_boxes<4>();
  check_boxes<5>();
}

TEST(Rounding, BoxesThatAreNotValidDoNotBecomeValid) {
  const Box<double, 2> inverted({0, 1.0}, {1, std::nextafter(1.0, 0)});
  EXPECT_FALSE(round_outward<float>(inverted).valid());
  EXPECT_FALSE(round_outward<float>(Box<double, 2>({0, Double::quiet_NaN()}, {1, 1})).valid());
  const Box<double, 2> everywhere({-Double::infinity(), -1e300}, {1e300, Double::infinity()});
  const Box<float, 2> rounded = round_outward<float>(everywhere);
  EXPECT_EQ(rounded, (Box<float, 2>({-Float::infinity(), -Float::infinity()}, {Float::infinity(), Float::infinity()})));
  EXPECT_TRUE((round_outward<float>(Box<double, 2>({0.1, 0.5}, {0.1, 0.5})).valid()));
}

template <class Scalar>
void check_sum(Scalar value, double by) {
  using Exact = long double;  // wide enough for what is tested here
  const Scalar above = sum_above(value, by);
  const Scalar below = sum_below(value, by);
  EXPECT_GE(static_cast<Exact>(above), static_cast<Exact>(value) + by) << value << " + " << by;
  EXPECT_LE(static_cast<Exact>(below), static_cast<Exact>(value) - by) << value << " - " << by;
  const Exact slack = 2 * static_cast<Exact>(std::numeric_limits<Scalar>::min()) +
                      3 * std::numeric_limits<Scalar>::epsilon() * (std::fabs(static_cast<Exact>(value)) + by);
  if (std::isfinite(above)) {
    EXPECT_LE(static_cast<Exact>(above), static_cast<Exact>(value) + by + slack);
  }
  if (std::isfinite(below)) {
    EXPECT_GE(static_cast<Exact>(below), static_cast<Exact>(value) - by - slack);
  }
}

TEST(Rounding, SumsReachAsFarAsTheyShould) {
  const std::vector<double> values = interesting();
  std::mt19937_64 random(3);
  for (const double value : values) {
    const double by = std::fabs(values[random() % values.size()]);
    if (std::isinf(by) || by > 1e300) continue;
    if (!std::isinf(value) && std::fabs(value) < 1e300) check_sum(value, by);
    if (const auto narrow = static_cast<float>(value); !std::isinf(narrow) && by < 1e30) check_sum(narrow, by);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(sum_above(value, 0)), std::bit_cast<std::uint64_t>(value));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(sum_below(value, 0)), std::bit_cast<std::uint64_t>(value));
  }
  EXPECT_EQ(sum_above(Double::infinity(), 1), Double::infinity());
  EXPECT_EQ(sum_above(-Double::infinity(), 1), -Double::infinity());
  EXPECT_EQ(sum_below(-Float::infinity(), 1), -Float::infinity());
}

TEST(Rounding, SumsReachAsFarInEveryMode) {
  const std::vector<double> values = interesting();
  struct Case {
    float value, above, below;
    double by;
  };
  for (const ClientMode::Kind kind : ClientMode::kinds()) {
    std::vector<Case> cases;
    {
      const ClientMode client(kind);
      for (std::size_t i = 0; i + 1 < values.size(); ++i) {
        const double by =
            std::bit_cast<double>(std::bit_cast<std::uint64_t>(values[i + 1]) & ~(std::uint64_t{1} << 63));
        if (std::isinf(by) || by > 1e30) continue;
        const float value = round_below(values[i]);
        if (std::isinf(value)) continue;
        cases.push_back({value, sum_above(value, by), sum_below(value, by), by});
      }
      // The least step of integers is one, however little is to be added.
      EXPECT_EQ(sum_above(std::int32_t{5}, 1e-310), 6);
      EXPECT_EQ(sum_below(std::int32_t{5}, 1e-310), 4);
      EXPECT_EQ(sum_above(std::int32_t{5}, 2.5), 8);
      EXPECT_EQ(sum_below(std::int32_t{5}, 2.5), 2);
    }
    ASSERT_GT(cases.size(), 1000U);
    for (const Case& c : cases) {
      EXPECT_GE(static_cast<long double>(c.above), static_cast<long double>(c.value) + c.by)
          << c.value << " + " << c.by;
      EXPECT_LE(static_cast<long double>(c.below), static_cast<long double>(c.value) - c.by)
          << c.value << " - " << c.by;
    }
  }
}

TEST(Rounding, SumsOfIntegersStayInTheirType) {
  using Limits = std::numeric_limits<std::int32_t>;
  EXPECT_EQ(sum_above(std::int32_t{5}, 1.5), 7);
  EXPECT_EQ(sum_below(std::int32_t{5}, 1.5), 3);
  EXPECT_EQ(sum_above(Limits::max(), 0.1), Limits::max());
  EXPECT_EQ(sum_below(Limits::min(), 1e300), Limits::min());
  EXPECT_EQ(sum_above(Limits::min(), 4294967295.0), Limits::max());
  EXPECT_EQ(sum_below(Limits::max(), 4294967295.0), Limits::min());
  EXPECT_EQ(sum_above(std::int16_t{-5}, 3), -2);
  EXPECT_EQ(sum_above(std::uint16_t{65530}, 100), 65535);
  EXPECT_EQ(sum_below(std::uint8_t{3}, 3.5), 0);
  EXPECT_EQ(sum_above(std::numeric_limits<std::int64_t>::min(), 0x1p63), 0);
  EXPECT_EQ(sum_below(std::numeric_limits<std::uint64_t>::max(), 0x1p64), 0U);
}

}  // namespace
}  // namespace sweepgrid::rounding_test
