// Power laws found in points whose law is known.
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "measure/in_turn.hpp"
#include "measure/spread.hpp"
#include "study/fit.hpp"

namespace sweepgrid::study::study_fit_test {
namespace {

const std::vector<double> kX = {100, 200, 500, 1000, 3000, 10000, 30000};

TEST(PowerLaws, AreFoundExactlyWithoutNoise) {
  for (const double exponent : {-1.0, 0.0, 2.0 / 3, 5.0 / 3, 2.0}) {
    std::vector<double> y;
    y.reserve(kX.size());
    for (const double x : kX) y.push_back(0.25 * std::pow(x, exponent));
    const PowerLaw law = fit_power_law(kX, y);
    EXPECT_NEAR(law.exponent, exponent, 1e-12);
    EXPECT_NEAR(law.factor, 0.25, 1e-11);
    EXPECT_NEAR(law.exponent_high - law.exponent_low, 0, 1e-6);
    EXPECT_NEAR(law(400), 0.25 * std::pow(400, exponent), 1e-6 * std::pow(400, exponent));
  }
}

// The interval is right 95 times of 100: of 2000 tries about 1900, with a deviation of 10.
TEST(PowerLaws, IntervalCoversTheExponentAsOftenAsItSays) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.1);
  int covered = 0;
  for (int i = 0; i < 2000; ++i) {
    std::vector<double> y;
    y.reserve(kX.size());
    for (const double x : kX) y.push_back(3 * std::pow(x, 1.5) * std::exp(noise(random)));
    const PowerLaw law = fit_power_law(kX, y);
    if (law.exponent_low <= 1.5 && 1.5 <= law.exponent_high) ++covered;
  }
  EXPECT_GT(covered, 1850);
  EXPECT_LT(covered, 1950);
}

TEST(PowerLaws, RefuseWhatHasNoLogarithmOrNoSlope) {
  const auto fit = [](std::vector<double> x, std::vector<double> y) { return fit_power_law(x, y); };
  EXPECT_THROW(fit({1, 2}, {1, 2}), std::invalid_argument);
  EXPECT_THROW(fit({1, 2, 3}, {1, 2}), std::invalid_argument);
  EXPECT_THROW(fit({1, 2, 3}, {1, 0, 3}), std::invalid_argument);
  EXPECT_THROW(fit({-1, 2, 3}, {1, 2, 3}), std::invalid_argument);
  EXPECT_THROW(fit({1, 2, NAN}, {1, 2, 3}), std::invalid_argument);
  EXPECT_THROW(fit({2, 2, 2}, {1, 2, 3}), std::invalid_argument);
}

TEST(Spread, IsMedianLeastAndMost) {
  EXPECT_EQ(spread({}).median, 0);
  const Spread odd = spread({5, 1, 2});
  EXPECT_EQ(odd.median, 2);
  EXPECT_EQ(odd.low, 1);
  EXPECT_EQ(odd.high, 5);
  EXPECT_EQ(spread({4, 1, 2, 9}).median, 3);
}

TEST(MeasureInTurn, TakesEachContenderOnceARound) {
  std::vector<int> calls;
  const std::vector<std::function<double()>> contenders = {[&] { return calls.push_back(0), 1.0; },
                                                           [&] { return calls.push_back(1), 2.0; }};
  const auto samples = measure_in_turn(2, contenders);
  EXPECT_EQ(calls, (std::vector<int>{0, 1, 0, 1}));
  EXPECT_EQ(samples, (std::vector<std::vector<double>>{{1, 1}, {2, 2}}));
  EXPECT_EQ(ratios(samples[1], samples[0]), (std::vector<double>{2, 2}));
}

}  // namespace
}  // namespace sweepgrid::study::study_fit_test
