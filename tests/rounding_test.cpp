// Rounding never takes anything from a box, and gives it no more than it must.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <sweepgrid/sap/rounding.hpp>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace sweepgrid {
namespace {

using Double = std::numeric_limits<double>;
using Float = std::numeric_limits<float>;

/// Flushes denormals to zero, and reads them as zero, while it lives.
class FlushToZero {
 public:
#if defined(__SSE2__)
  FlushToZero() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040); }
  ~FlushToZero() { _mm_setcsr(before_); }
  FlushToZero(const FlushToZero&) = delete;
  FlushToZero& operator=(const FlushToZero&) = delete;

 private:
  unsigned before_;
#endif
};

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

TEST(Rounding, IsTheSameWhereDenormalsAreFlushed) {
  const std::vector<double> values = interesting();
  std::vector<std::array<std::uint32_t, 2>> flushed;
  {
    const FlushToZero flush;
    for (const double value : values) {
      flushed.push_back(
          {std::bit_cast<std::uint32_t>(round_below(value)), std::bit_cast<std::uint32_t>(round_above(value))});
    }
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(std::bit_cast<float>(flushed[i][0]), round_below(values[i])) << values[i];
    EXPECT_EQ(std::bit_cast<float>(flushed[i][1]), round_above(values[i])) << values[i];
  }
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

TEST(Rounding, SumsReachAsFarWhereDenormalsAreFlushed) {
  const std::vector<double> values = interesting();
  struct Case {
    float value, above, below;
    double by;
  };
  std::vector<Case> cases;
  {
    const FlushToZero flush;
    for (std::size_t i = 0; i + 1 < values.size(); ++i) {
      const double by = std::bit_cast<double>(std::bit_cast<std::uint64_t>(values[i + 1]) & ~(std::uint64_t{1} << 63));
      if (std::isinf(by) || by > 1e30) continue;
      const float value = round_below(values[i]);
      if (std::isinf(value)) continue;
      cases.push_back({value, sum_above(value, by), sum_below(value, by), by});
    }
  }
  ASSERT_GT(cases.size(), 1000U);
  for (const Case& c : cases) {
    EXPECT_GE(static_cast<long double>(c.above), static_cast<long double>(c.value) + c.by) << c.value << " + " << c.by;
    EXPECT_LE(static_cast<long double>(c.below), static_cast<long double>(c.value) - c.by) << c.value << " - " << c.by;
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
}  // namespace sweepgrid
