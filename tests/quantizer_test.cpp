// Quantised boxes miss no pair, wherever they lie, and hold what they were made of.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include <sweepgrid/sap/quantizer.hpp>

#include "client_mode.hpp"

namespace sweepgrid::quantizer_test {
namespace {

template <class Int>
class QuantizerOf : public ::testing::Test {};
using Integers = ::testing::Types<std::int16_t, std::int32_t, std::uint16_t, std::uint32_t, std::int8_t>;
TYPED_TEST_SUITE(QuantizerOf, Integers);

using World = Box<double, 2>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Boxes {
 public:
  Boxes(double centre, double spread, double width) : centre_(centre), spread_(spread), width_(width) {}
  World next() {
    World box;
    for (int axis = 0; axis < 2; ++axis) {
      box.min[axis] = centre_ + spread_ * (unit() - 0.5);
      box.max[axis] = box.min[axis] + (random_() % 4 == 0 ? 0 : width_ * unit());
    }
    return box;
  }

 private:
  double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  std::mt19937_64 random_{11};
  double centre_, spread_, width_;
};

TYPED_TEST(QuantizerOf, MissesNoPairAtAnyDistance) {
  for (const double distance : {0.0, 1e3, -1e8, 1e15, 1e30}) {
    Boxes boxes(distance, 100 + std::fabs(distance) * 1e-15, 3);
    std::vector<World> world;
    for (int i = 0; i < 300; ++i) world.push_back(boxes.next());
    world.emplace_back(World::Point{-kInfinity, 0}, World::Point{kInfinity, 0});
    world.emplace_back(World::Point{1e200, 1e200}, World::Point{1e201, 1e201});
    for (const double resolution : {1e-9, 1e-3, 0.7, 50.0}) {
      const Quantizer<TypeParam, 2> quantize({distance, 0}, resolution);
      int overlapping = 0;
      for (const World& a : world) {
        for (const World& b : world) {
          if (!a.overlaps(b)) continue;
          ++overlapping;
          EXPECT_TRUE(quantize(a).overlaps(quantize(b))) << resolution;
        }
      }
      EXPECT_GT(overlapping, 300);
    }
  }
}

TYPED_TEST(QuantizerOf, BoxesWithinTheWorldAreHeldAndTheRestIsAtTheEnds) {
  using Limits = std::numeric_limits<TypeParam>;
  for (const double distance : {0.0, 1e3, -1e8, 1e12}) {
    const World all({distance - 50, distance - 20}, {distance + 50, distance + 60});
    const auto quantize = Quantizer<TypeParam, 2>::covering(all);
    const double step = quantize.resolution();
    EXPECT_LT(std::ldexp(step, std::numeric_limits<std::make_unsigned_t<TypeParam>>::digits), 100 * 2.2);
    const Box<TypeParam, 2> whole = quantize(all);
    Boxes boxes(distance, 35, 3);
    for (int i = 0; i < 2000; ++i) {
      const World box = boxes.next();
      const Box<TypeParam, 2> small = quantize(box);
      ASSERT_TRUE(small.valid());
      for (int axis = 0; axis < 2; ++axis) {
        EXPECT_GE(small.min[axis], whole.min[axis]);
        EXPECT_LE(small.max[axis], whole.max[axis]);
        EXPECT_GT(small.min[axis], Limits::min());  // nothing is cut off
        EXPECT_LT(small.max[axis], Limits::max());
        // Exactly outward: as far as from the origin, which is a whole number of steps.
        const double from_lower = box.min[axis] / step - std::floor(box.min[axis] / step);
        const double width = (box.max[axis] - box.min[axis]) / step;
        EXPECT_GE(small.max[axis] - small.min[axis], std::floor(width + from_lower));
        EXPECT_LE(small.max[axis] - small.min[axis], std::ceil(width + from_lower) + 1);
      }
    }
    const Box<TypeParam, 2> beyond = quantize(World({distance + 1e6, -kInfinity}, {kInfinity, kInfinity}));
    EXPECT_EQ(beyond.min[0], Limits::max());
    EXPECT_EQ(beyond.max[0], Limits::max());
    EXPECT_EQ(beyond.min[1], Limits::min());
    EXPECT_EQ(beyond.max[1], Limits::max());
  }
}

TYPED_TEST(QuantizerOf, IsMonotone) {
  const Quantizer<TypeParam, 1> quantize({0.3}, 0.01);
  std::mt19937_64 random(5);
  for (int i = 0; i < 20'000; ++i) {
    double a = std::bit_cast<double>(random());
    double b = i % 2 == 0 ? std::bit_cast<double>(random()) : std::nextafter(a, kInfinity);
    if (std::isnan(a) || std::isnan(b)) continue;
    if (b < a) std::swap(a, b);
    EXPECT_LE(quantize({{a}, {a}}).min[0], quantize({{b}, {b}}).min[0]);
    EXPECT_LE(quantize({{a}, {a}}).max[0], quantize({{b}, {b}}).max[0]);
    EXPECT_LE(quantize({{a}, {a}}).min[0], quantize({{a}, {a}}).max[0]);
  }
}

TYPED_TEST(QuantizerOf, BoxesThatAreNotValidDoNotBecomeValid) {
  const Quantizer<TypeParam, 2> quantize({0, 0}, 1);
  EXPECT_FALSE(quantize({{0, 0.6}, {1, 0.5}}).valid());
  EXPECT_FALSE(quantize({{0, std::nan("")}, {1, 1}}).valid());
}

TYPED_TEST(QuantizerOf, GivesTheSameBoxesInEveryMode) {
  std::vector<Quantizer<TypeParam, 2>> quantizers;
  for (const double resolution : {1e-300, 1e-3, 0.7, 1e300}) quantizers.push_back({{0.3, -2}, resolution});
  std::vector<World> boxes;
  std::mt19937_64 random(9);
  for (int i = 0; i < 20'000; ++i) {
    const auto number = [&] {
      return i % 2 == 0 ? std::bit_cast<double>(random()) : static_cast<double>(random() % 1000) * 0.01 - 5;
    };
    boxes.emplace_back(World::Point{number(), number()}, World::Point{number(), number()});
  }
  std::vector<Box<TypeParam, 2>> expected;
  for (const World& box : boxes) {
    for (const auto& quantize : quantizers) expected.push_back(quantize(box));
  }
  for (const oracle::ClientMode::Kind kind : oracle::ClientMode::kinds()) {
    std::size_t wrong = 0;
    {
      const oracle::ClientMode client(kind);
      std::size_t next = 0;
      for (const World& box : boxes) {
        for (const auto& quantize : quantizers) wrong += quantize(box) == expected[next++] ? 0 : 1;
      }
    }
    EXPECT_EQ(wrong, 0U) << kind.flush << ' ' << kind.rounding;
  }
}

TEST(Quantizer, KeepsThinThingsNearZeroApartFromZero) {
  const Quantizer<std::int32_t, 1> quantize({0}, 0x1p100);
  EXPECT_EQ(quantize({{-1e-300}, {-1e-300}}), (Box<std::int32_t, 1>({-1}, {0})));
  EXPECT_EQ(quantize({{1e-300}, {1e-300}}), (Box<std::int32_t, 1>({0}, {1})));
  EXPECT_EQ(quantize({{-0.0}, {0.0}}), (Box<std::int32_t, 1>({0}, {0})));
}

TEST(Quantizer, RefusesWhatItCannotServe) {
  using Quantizer2 = Quantizer<std::int32_t, 2>;
  EXPECT_THROW(Quantizer2({0, 0}, 0), std::invalid_argument);
  EXPECT_THROW(Quantizer2({0, 0}, -1), std::invalid_argument);
  EXPECT_THROW(Quantizer2({0, 0}, kInfinity), std::invalid_argument);
  EXPECT_THROW(Quantizer2({0, std::nan("")}, 1), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(Quantizer2::covering({{0, 0}, {1, kInfinity}})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(Quantizer2::covering({{0, 2}, {1, 1}})), std::invalid_argument);
  EXPECT_EQ(Quantizer2({0, 0}, 0.7).resolution(), 0.5);
  EXPECT_GT(Quantizer2::covering({{0, 0}, {0, 0}}).resolution(), 0);
}

}  // namespace
}  // namespace sweepgrid::quantizer_test
