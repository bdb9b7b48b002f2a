// ObjectSpeed: what an object does in two steps is its speed, what it does in one is not.
#include <gtest/gtest.h>

#include <cstdint>

#include <sweepgrid/engine/object_speed.hpp>

namespace sweepgrid::object_speed_test {
namespace {

const double kFade = ObjectSpeed::fade_of(1);

TEST(ObjectSpeed, IsTheDisplacementOfEvenMotion) {
  ObjectSpeed speed;
  speed.appear(5);
  EXPECT_EQ(speed.at(5, kFade), 0);
  for (std::uint32_t step = 6; step < 100; ++step) {
    speed.note(0.3, step, kFade);
    EXPECT_EQ(speed.at(step, kFade), 0.3) << step;
  }
}

TEST(ObjectSpeed, FadesAtRest) {
  ObjectSpeed speed;
  speed.appear(0);
  speed.note(8, 1, kFade);
  EXPECT_EQ(speed.at(2, kFade), 7);
  EXPECT_EQ(speed.at(3, kFade), 8 * 0.875 * 0.875);
  EXPECT_LT(speed.at(100, kFade), 1e-4);
  EXPECT_EQ(speed.at(4'000'000'000U, kFade), 0);
  const double slow = ObjectSpeed::fade_of(4);
  EXPECT_NEAR(speed.at(5, slow), 7, 0.1);
}

TEST(ObjectSpeed, IsNotThatOfASingleJump) {
  ObjectSpeed speed;
  speed.appear(0);
  for (std::uint32_t step = 1; step < 100; ++step) {
    speed.note(step % 10 == 3 ? 1000 : 0.1, step, kFade);
    EXPECT_LE(speed.at(step, kFade), 0.1) << step;
    EXPECT_GT(speed.at(step, kFade), 0.05) << step;
  }
  // Nor of one after a rest, or of a pair of updates before one step.
  speed.note(1000, 120, kFade);
  speed.note(1000, 120, kFade);
  EXPECT_LT(speed.at(120, kFade), 0.1);
}

TEST(ObjectSpeed, TakesNoNoteOfUpdatesThatMoveNothing) {
  ObjectSpeed speed;
  speed.appear(0);
  for (std::uint32_t step = 1; step < 50; ++step) {
    speed.note(step % 3 == 0 ? 2 : 0, step, kFade);
    if (step >= 3) {
      EXPECT_GT(speed.at(step, kFade), 1.5) << step;
    }
  }
}

}  // namespace
}  // namespace sweepgrid::object_speed_test
