// Engines for numbers of axes and scalars that are not compiled ahead.
#include <gtest/gtest.h>

#include <cstdint>

#include <sweepgrid/engine/keyed_engine.inl.hpp>

#include "engine_oracle.hpp"
#include "engine_pairing.hpp"

namespace sweepgrid {

template class KeyedEngine<float, 1>;
template class KeyedEngine<double, 4>;
template class KeyedEngine<std::int64_t, 2>;

}  // namespace sweepgrid

namespace sweepgrid::engine_other_types_test {
namespace {

using oracle::Pairing;
using oracle::Random;

Config sweeps(int threads) {
  Config config;
  config.step_method = StepMethod::kSweep;
  config.threads = threads;
  return config;
}

template <class Scalar, int Dim>
void play_line(Scalar scale) {
  for (const int threads : {1, 2}) {
    Pairing<Scalar, Dim> scene(sweeps(threads));
    Random random(9);
    for (int step = 0; step < 12; ++step) {
      for (std::uint64_t key = 0; key < 150; ++key) {
        if (step > 0 && random.percent(30)) continue;
        if (scene.engine.contains(key) && random.percent(10)) {
          scene.erase(key);
          continue;
        }
        Box<Scalar, Dim> box;
        for (int axis = 0; axis < Dim; ++axis) {
          box.min[axis] = static_cast<Scalar>(random.below(60)) * scale;
          box.max[axis] = box.min[axis] + static_cast<Scalar>(random.below(Dim == 1 ? 2 : 20)) * scale;
        }
        scene.put(key, box);
      }
      ASSERT_EQ(scene.step(), "") << "step " << step;
    }
    EXPECT_EQ(scene.engine.stats().total.sweeps, 12u);
  }
}

TEST(OtherTypes, SweepOnOneAxisAndOnFour) {
  play_line<float, 1>(0.5F);
  play_line<double, 4>(0.5);
}

// To double, neighbouring 64-bit integers are one and the same number.
TEST(OtherTypes, SweepsAreExactForIntegersThatTheyRound) {
  play_line<std::int64_t, 2>(1);
  Pairing<std::int64_t, 2> scene(sweeps(1));
  constexpr std::int64_t kBig = (std::int64_t{1} << 60) + 1;
  for (std::int64_t i = 0; i < 100; ++i) {
    const std::int64_t x = kBig + 3 * (i % 10);
    const std::int64_t y = kBig + 3 * (i / 10);
    scene.put(static_cast<std::uint64_t>(i), {{x, y}, {x + 2, y + 2}});  // a gap of one between neighbours
  }
  ASSERT_EQ(scene.step(), "");
  EXPECT_TRUE(scene.engine.pairs().empty());
  for (std::int64_t i = 0; i < 100; i += 2) {
    const std::int64_t x = kBig + 3 * (i % 10) + 1;
    const std::int64_t y = kBig + 3 * (i / 10);
    scene.put(static_cast<std::uint64_t>(i), {{x, y}, {x + 2, y + 2}});
  }
  ASSERT_EQ(scene.step(), "");
  EXPECT_FALSE(scene.events->begins.empty());
}

TEST(OtherTypes, WhoIsEverywhereBeginsWithAllAndEndsWithAll) { oracle::meet_everywhere<std::int64_t>(); }

}  // namespace
}  // namespace sweepgrid::engine_other_types_test
