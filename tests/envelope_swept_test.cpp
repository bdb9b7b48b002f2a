// Swept boxes miss no pair that overlaps at some time between two steps, at any speed: compared with a continuous test
// in exact arithmetic, for coordinates are whole numbers.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "envelope_play.hpp"

namespace sweepgrid::oracle::envelope_swept_test {
namespace {

__extension__ using Wide = __int128;

/// A time as a fraction; the denominator is positive.
struct Time {
  Wide over;
  Wide under;
  friend bool operator<(const Time& a, const Time& b) { return a.over * b.under < b.over * a.under; }
};

/// Narrows [first, last] to the times at which `at_0` + t (`at_1` - `at_0`) >= 0. Returns false when none are left.
bool narrow(std::int64_t at_0, std::int64_t at_1, Time& first, Time& last) {
  if (at_0 < 0 && at_1 < 0) return false;
  if (at_0 >= 0 && at_1 >= 0) return true;
  const std::int64_t slope = at_1 - at_0;
  if (slope > 0) {
    const Time from{-Wide{at_0}, slope};
    if (first < from) first = from;
  } else {
    const Time until{at_0, -Wide{slope}};
    if (until < last) last = until;
  }
  return !(last < first);
}

template <int Dim>
using Whole = Box<std::int64_t, Dim>;

/// Whether two boxes that move linearly, both in the same time, overlap at some time.
template <int Dim>
bool meet(const Whole<Dim>& a0, const Whole<Dim>& a1, const Whole<Dim>& b0, const Whole<Dim>& b1) {
  Time first{0, 1};
  Time last{1, 1};
  for (int axis = 0; axis < Dim; ++axis) {
    if (!narrow(a0.max[axis] - b0.min[axis], a1.max[axis] - b1.min[axis], first, last)) return false;
    if (!narrow(b0.max[axis] - a0.min[axis], b1.max[axis] - a1.min[axis], first, last)) return false;
  }
  return true;
}

TEST(ContinuousTest, KnowsWhatItShouldKnow) {
  using Box1 = Whole<1>;
  EXPECT_TRUE(meet<1>(Box1({0}, {1}), Box1({10}, {11}), Box1({5}, {6}), Box1({5}, {6})));
  EXPECT_FALSE(meet<1>(Box1({0}, {1}), Box1({3}, {4}), Box1({5}, {6}), Box1({5}, {6})));
  EXPECT_TRUE(meet<1>(Box1({0}, {1}), Box1({4}, {5}), Box1({5}, {6}), Box1({5}, {6})));
  using Box2 = Whole<2>;
  const Box2 rests({10, 10}, {11, 11});
  EXPECT_TRUE(meet<2>(Box2({0, 0}, {1, 1}), Box2({20, 20}, {21, 21}), rests, rests));
  EXPECT_TRUE(meet<2>(Box2({0, 2}, {1, 3}), Box2({20, 22}, {21, 23}), rests, rests));   // just touches
  EXPECT_FALSE(meet<2>(Box2({0, 3}, {1, 4}), Box2({20, 23}, {21, 24}), rests, rests));  // passes by
}

/// Boxes that fly, rest, appear and vanish; each knows where it is and where it was.
template <int Dim>
class Flight {
 public:
  struct Body {
    std::uint64_t key;
    bool fresh;
    Whole<Dim> before, now;
    std::array<int, Dim> velocity;
  };

  Flight(int population, int widths_per_step, std::uint64_t seed) : random_(seed), speed_(widths_per_step) {
    for (int i = 0; i < population; ++i) bodies_.push_back(anywhere());
  }

  /// By how much a body goes now; remembered by the body.
  void turn(Body& body) {
    for (int axis = 0; axis < Dim; ++axis) {
      const auto width = static_cast<int>(body.now.max[axis] - body.now.min[axis]) + 1;
      body.velocity[axis] = random_() % 4 == 0 ? 0 : between(-speed_ * width, speed_ * width);
    }
    if (random_() % 3 == 0) body.velocity.fill(0);
  }
  void advance(Body& body) {
    body.before = body.now;
    for (int axis = 0; axis < Dim; ++axis) {
      body.now.min[axis] += body.velocity[axis];
      body.now.max[axis] += body.velocity[axis];
    }
  }
  Body anywhere() {
    Body body{next_key_++, true, {}, {}, {}};
    for (int axis = 0; axis < Dim; ++axis) {
      body.now.min[axis] = between(-kSpace, kSpace);
      body.now.max[axis] = body.now.min[axis] + between(0, kWidth);
    }
    body.before = body.now;
    turn(body);
    return body;
  }
  [[nodiscard]] std::vector<Body>& bodies() { return bodies_; }

  /// Pairs that overlap at some time since the last step, sorted.
  [[nodiscard]] Pairs pairs() const {
    Pairs pairs;
    for (const Body& a : bodies_) {
      for (const Body& b : bodies_) {
        if (a.key < b.key && meet<Dim>(a.before, a.now, b.before, b.now)) pairs.push_back({a.key, b.key});
      }
    }
    std::sort(pairs.begin(), pairs.end(), pair_less);
    return pairs;
  }

  int between(int low, int high) { return low + static_cast<int>(random_() % static_cast<unsigned>(high - low + 1)); }

 private:
  static constexpr int kSpace = 1000;
  static constexpr int kWidth = 12;

  std::mt19937_64 random_;
  int speed_;
  std::uint64_t next_key_ = 0;
  std::vector<Body> bodies_;
};

template <class Scalar, int Dim>
Box<Scalar, Dim> as(const Whole<Dim>& box) {
  Box<Scalar, Dim> result;
  for (int axis = 0; axis < Dim; ++axis) {
    result.min[axis] = static_cast<Scalar>(box.min[axis]);
    result.max[axis] = static_cast<Scalar>(box.max[axis]);
  }
  return result;
}

Config config_of(std::size_t turn, const EnvelopeOptions& options) {
  Config config;
  config.cell.kind = kKinds[turn % kKinds.size()];
  config.reduction = turn % 3 == 0 ? Reduction::kWitnessCounts : Reduction::kSingleReporter;
  config.threads = turn % 2 == 0 ? 1 : 2;
  config.parallel_from = 0;
  config.envelope = options;
  return config;
}

/// Says how many pairs were missed in which step; nothing when none. `met`: counts pairs that no step saw.
template <class Scalar, int Dim>
std::string fly(const Config& config, int widths_per_step, std::size_t& met_between) {
  Engine<Scalar, Dim> engine(config);
  Flight<Dim> flight(150, widths_per_step, static_cast<std::uint64_t>(widths_per_step) + Dim);
  for (const auto& body : flight.bodies()) engine.insert(body.key, as<Scalar>(body.now));
  engine.step();
  for (int step = 0; step < 12; ++step) {
    for (auto& body : flight.bodies()) {
      body.fresh = false;
      if (flight.between(0, 30) == 0) {
        engine.erase(body.key);
        body = flight.anywhere();
        engine.insert(body.key, as<Scalar>(body.now));
        continue;
      }
      flight.turn(body);
      flight.advance(body);
      // Of two updates only the last one counts.
      const bool twice = flight.between(0, 9) == 0;
      if (twice) engine.update(body.key, as<Scalar>(flight.anywhere().now));
      if (twice || body.before != body.now || flight.between(0, 1) == 0) engine.update(body.key, as<Scalar>(body.now));
    }
    engine.step();
    engine.validate();
    const Pairs pairs = engine.pairs();
    const Pairs wanted = flight.pairs();
    const Pairs lost = missed(wanted, pairs);
    if (!lost.empty()) return std::to_string(lost.size()) + " pairs are missed in step " + std::to_string(step);
    for (const auto& pair : wanted) {
      const auto now = [&](std::uint64_t key) { return engine.box(engine.find(key).value()); };
      met_between += now(pair.first).overlaps(now(pair.second)) ? 0 : 1;
    }
  }
  return {};
}

TEST(Swept, MissesNothingBetweenStepsAtAnySpeed) {
  std::size_t turn = 0;
  for (const int speed : {0, 1, 2, 10, 100}) {
    for (const double margin : {0.0, 3.0}) {
      std::size_t between = 0;
      const EnvelopeOptions options{.margin = margin, .swept = true};
      EXPECT_EQ((fly<float, 3>(config_of(++turn, options), speed, between)), "") << speed;
      EXPECT_EQ((fly<double, 2>(config_of(++turn, options), speed, between)), "") << speed;
      EXPECT_EQ((fly<std::int32_t, 2>(config_of(++turn, options), speed, between)), "") << speed;
      if (speed >= 10) {
        EXPECT_GT(between, 30U);  // or the test would prove nothing
      }
    }
  }
}

TEST(Swept, AnObjectThatStopsShrinksByItself) {
  for (const int threads : {1, 2}) {
    Config config;
    config.threads = threads;
    config.parallel_from = 0;
    config.envelope = EnvelopeOptions{.swept = true};
    Engine<float, 2> engine(config);
    const Handle flies = engine.insert(1, {{0, 0}, {1, 1}});
    engine.insert(2, {{5, 0}, {6, 1}});
    EXPECT_TRUE(engine.step().begins.empty());
    engine.update(flies, {{10, 0}, {11, 1}});
    EXPECT_EQ(engine.step().begins, (Pairs{{1, 2}}));
    EXPECT_EQ(engine.envelope(flies), (Box<float, 2>({0, 0}, {11, 1})));
    EXPECT_EQ(engine.box(flies), (Box<float, 2>({10, 0}, {11, 1})));
    EXPECT_EQ(engine.step().ends, (Pairs{{1, 2}}));
    EXPECT_EQ(engine.envelope(flies), engine.box(flies));
    EXPECT_EQ(engine.stats().step.updates, 1U);
    engine.step();
    EXPECT_EQ(engine.stats().step.updates, 0U);
    engine.validate();
  }
}

// With displacements, the step covers the way that lies ahead.
template <class Scalar, int Dim>
std::string fly_ahead(const Config& config, int widths_per_step) {
  Engine<Scalar, Dim> engine(config);
  Flight<Dim> flight(150, widths_per_step, 77);
  const auto tell = [&](auto& body) {
    std::array<double, Dim> ahead;
    for (int axis = 0; axis < Dim; ++axis) ahead[axis] = body.velocity[axis];
    engine.update(engine.find(body.key).value(), as<Scalar>(body.now), ahead);
  };
  for (auto& body : flight.bodies()) {
    engine.insert(body.key, as<Scalar>(body.now));
    tell(body);
  }
  for (int step = 0; step < 12; ++step) {
    engine.step();
    if (!engine.envelope_report().outside.empty()) return "the report names objects that went where they were to go";
    const Pairs pairs = engine.pairs();
    for (auto& body : flight.bodies()) flight.advance(body);
    if (!missed(flight.pairs(), pairs).empty()) return "pairs are missed after step " + std::to_string(step);
    for (auto& body : flight.bodies()) {
      flight.turn(body);
      tell(body);
    }
  }
  return {};
}

TEST(Swept, MissesNothingOnTheWayAhead) {
  std::size_t turn = 0;
  for (const int speed : {1, 10, 100}) {
    const EnvelopeOptions options{.swept = true};
    EXPECT_EQ((fly_ahead<float, 2>(config_of(++turn, options), speed)), "") << speed;
    EXPECT_EQ((fly_ahead<double, 3>(config_of(++turn, options), speed)), "") << speed;
    EXPECT_EQ((fly_ahead<std::int32_t, 3>(config_of(++turn, options), speed)), "") << speed;
  }
}

TEST(Swept, WhoGoesElsewhereThanWasSaidIsNamed) {
  Config config;
  config.envelope = EnvelopeOptions{.swept = true};
  Engine<double, 2> engine(config);
  const Handle honest = engine.insert(1, {{0, 0}, {1, 1}});
  const Handle liar = engine.insert(2, {{100, 0}, {101, 1}});
  engine.update(honest, {{0, 0}, {1, 1}}, {5, 0});
  engine.update(liar, {{100, 0}, {101, 1}}, {5, 0});
  engine.step();
  EXPECT_EQ(engine.envelope(honest).min[0], 0);
  EXPECT_GE(engine.envelope(honest).max[0], 6);
  EXPECT_LE(engine.envelope(honest).max[0], 6.001);
  engine.update(honest, {{5, 0}, {6, 1}}, {5, 0});
  engine.update(liar, {{95, 0}, {96, 1}}, {5, 0});
  engine.step();
  EXPECT_EQ(engine.envelope_report().outside, std::vector{liar});
  EXPECT_EQ(engine.envelope_report().violations, 1U);
  // An update without a displacement covers the way that was gone, wherever that led.
  engine.update(liar, {{50, 0}, {51, 1}});
  engine.step();
  EXPECT_TRUE(engine.envelope_report().outside.empty());
  EXPECT_LE(engine.envelope(liar).min[0], 50);
  EXPECT_GE(engine.envelope(liar).max[0], 96);
}

TEST(Swept, AStrideCoversTheWaySinceTheLatestQuery) {
  Config config;
  config.envelope = EnvelopeOptions{.swept = true, .stride = 3};
  Engine<float, 2> engine(config);
  const Handle flies = engine.insert(1, {{0, 0}, {1, 1}});
  engine.insert(2, {{50, 50}, {51, 51}});
  engine.step();
  engine.update(flies, {{50, 50}, {51, 51}});
  EXPECT_TRUE(engine.step().begins.empty());
  EXPECT_EQ(engine.envelope_report().outside, std::vector{flies});
  engine.update(flies, {{0, 100}, {1, 101}});
  EXPECT_TRUE(engine.step().begins.empty());
  engine.update(flies, {{0, 0}, {1, 1}});
  EXPECT_EQ(engine.step().begins, (Pairs{{1, 2}}));
  EXPECT_EQ(engine.envelope(flies), (Box<float, 2>({0, 0}, {51, 101})));
}

}  // namespace
}  // namespace sweepgrid::oracle::envelope_swept_test
