// What a client's floating-point mode is does not matter, in the thread that calls or in all: pairs are those of brute
// force by integers, events and counters those of the standard mode, and the client's mode is as it was.
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <sweepgrid/engine/engine.hpp>
#include <sweepgrid/scheduler/executor.hpp>

#include "client_mode.hpp"
#include "clients/scene.hpp"
#include "sanitized.hpp"

namespace sweepgrid::modes::engine_modes_test {
namespace {

using clients::Regime;
using clients::Unit;
using oracle::ClientMode;
using oracle::mode_register;

/// A client's own threads, each in a mode of its own.
class ThreadsInMode final : public Executor {
 public:
  explicit ThreadsInMode(ClientMode::Kind kind) : kind_(kind) {}
  [[nodiscard]] int concurrency() const override { return 2; }
  [[nodiscard]] int worker() const override { return worker_; }
  void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override {
    std::thread other([&] {
      const ClientMode mode(kind_);
      worker_ = 1;
      for (std::size_t i = 0; i < count; i += 2) body(i);
    });
    for (std::size_t i = 1; i < count; i += 2) body(i);
    other.join();
  }
  void execute(const std::function<void()>& work) override { work(); }

 private:
  static inline thread_local int worker_ = 0;
  ClientMode::Kind kind_;
};

/// Which threads are in the client's mode.
enum class Where { kNone, kCaller, kAll, kOwnThreads };

struct Played {
  std::vector<Events<std::uint64_t>> events;
  std::vector<StepCounters> counters;
  std::size_t wrong = 0;    ///< steps with other pairs than brute force
  std::size_t changed = 0;  ///< calls that left another mode behind
};

Regime denormals(int objects) { return {"denormal", 2000, 150, Unit::kDenormal, objects, 6, false}; }

template <class Scalar, int Dim>
Played play(const Regime& regime, ClientMode::Kind kind, Where where, int threads, bool margins) {
  Config config;
  config.threads = threads;
  config.parallel_from = 0;
  if (margins) config.envelope.emplace().margin = 0.5, config.envelope->exact = true;
  if (where == Where::kCaller) config.executor = make_executor(threads);
  if (where == Where::kOwnThreads) config.executor = std::make_shared<ThreadsInMode>(kind);
  const ClientMode mode(where == Where::kNone ? ClientMode::Kind{} : kind);
  const std::uint64_t before = mode_register();
  Played played;
  const auto look = [&] { played.changed += mode_register() == before ? 0 : 1; };

  clients::Scene<Scalar, Dim> scene(regime, 11);
  Engine<Scalar, Dim> engine(config);
  look();
  std::uint64_t next_key = 0;
  for (int step = 0; step < regime.steps; ++step) {
    std::vector<std::uint64_t> keys;
    std::vector<Handle> handles;
    std::vector<typename Engine<Scalar, Dim>::BoxType> boxes;
    for (auto at = scene.objects.begin(); at != scene.objects.end();) {
      const std::int64_t fate = scene.random().below(10);
      if (fate == 0) {
        engine.erase(at->first);
        look();
        at = scene.objects.erase(at);
        continue;
      }
      if (fate < 6) at->second = fate == 1 ? scene.place() : scene.near(at->second);
      if (fate < 3) {
        engine.update(at->first, scene.box(at->second));
        look();
      } else if (fate < 6) {
        handles.push_back(*engine.find(at->first));
        boxes.push_back(scene.box(at->second));
      }
      ++at;
    }
    engine.update(handles, boxes);
    look();
    boxes.clear();
    while (scene.objects.size() < static_cast<std::size_t>(regime.objects)) {
      const auto steps = scene.place();
      scene.objects.emplace(next_key, steps);
      keys.push_back(next_key++);
      boxes.push_back(scene.box(steps));
    }
    engine.insert(keys, boxes);
    look();
    played.events.push_back(engine.step());
    look();
    played.counters.push_back(engine.stats().step);
    const auto expected = scene.pairs();
    const auto pairs = engine.pairs();
    look();
    played.wrong += std::equal(pairs.begin(), pairs.end(), expected.begin(), expected.end(),
                               [](const auto& a, const auto& b) { return a.first == b.first && a.second == b.second; })
                        ? 0
                        : 1;
    engine.validate();
    look();
  }
  return played;
}

template <class Scalar, int Dim>
void check(const Regime& regime, bool margins) {
  const Played expected = play<Scalar, Dim>(regime, {}, Where::kNone, 1, margins);
  EXPECT_EQ(expected.wrong, 0U);
  for (const ClientMode::Kind kind : ClientMode::kinds()) {
    for (const Where where : {Where::kCaller, Where::kAll, Where::kOwnThreads}) {
      for (const int threads : {1, 3}) {
        const Played played = play<Scalar, Dim>(regime, kind, where, threads, margins);
        const std::string what = std::string(regime.name) + (kind.flush ? ", flushing" : "") + ", rounding " +
                                 std::to_string(kind.rounding) + ", where " + std::to_string(static_cast<int>(where)) +
                                 ", " + std::to_string(threads) + " threads";
        EXPECT_EQ(played.wrong, 0U) << what;
        EXPECT_EQ(played.changed, 0U) << what;
        EXPECT_TRUE(played.events == expected.events) << what;
        EXPECT_TRUE(played.counters == expected.counters) << what;
      }
    }
  }
}

TEST(EngineModes, DenormalBoxesAreToldApart) {
  check<float, 2>(denormals(100), false);
  check<double, 3>(denormals(100), false);
}

TEST(EngineModes, BoxesOfCommonSizeTakeTheSameCells) {
  check<float, 3>({"common", 400, 24, Unit::kQuarter, 100, 6, true}, false);
}

TEST(EngineModes, ExactEnvelopesStayExact) {
  check<float, 2>({"margins", 400, 24, Unit::kQuarter, 80, 6, false}, true);
}

TEST(EngineModes, BulkCallsOfManyObjectsAreRightToo) {
  Regime many =
      denormals(oracle::kSanitized && !oracle::plays_all() ? 2500 : 6000);  // enough for shares on several workers
  many.world = 400'000;
  many.steps = 2;
  const Played expected = play<float, 2>(many, {}, Where::kNone, 1, false);
  EXPECT_EQ(expected.wrong, 0U);
  const Played played = play<float, 2>(many, {true, FE_DOWNWARD}, Where::kAll, 3, false);
  EXPECT_EQ(played.wrong + played.changed, 0U);
  EXPECT_TRUE(played.events == expected.events);
}

TEST(EngineModes, NaNAndInvertedDenormalBoxesAreRefusedByEveryCall) {
  using Box3 = Box<float, 3>;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float denormal = std::numeric_limits<float>::denorm_min();
  std::vector<Box3> bad;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Box3 box({0, 0, 0}, {1, 1, 1});
    bad.assign(3, box);
    bad[0].min[axis] = nan;
    bad[1].max[axis] = nan;
    bad[2].min[axis] = 300 * denormal, bad[2].max[axis] = 100 * denormal;
    for (const ClientMode::Kind kind : ClientMode::kinds()) {
      for (const bool margins : {false, true}) {
        Config config;
        config.threads = 2;
        config.parallel_from = 0;
        if (margins) config.envelope.emplace().margin = 0.5;
        const ClientMode mode(kind);
        Engine<float, 3> engine(config);
        const Handle handle = engine.insert(1, box);
        for (const Box3& wrong : bad) {
          const std::vector<Box3> boxes = {box, wrong};
          const std::vector<std::uint64_t> keys = {5, 6};
          const std::vector<Handle> handles = {handle, handle};
          EXPECT_THROW(engine.insert(2, wrong), std::invalid_argument);
          EXPECT_THROW(engine.insert(keys, boxes), std::invalid_argument);
          EXPECT_THROW(engine.update(handle, wrong), std::invalid_argument);
          EXPECT_THROW(engine.update(std::uint64_t{1}, wrong), std::invalid_argument);
          EXPECT_THROW(engine.update(handles, boxes), std::invalid_argument);
        }
        EXPECT_EQ(engine.size(), 1U);
        EXPECT_EQ(engine.box(handle), box);
      }
    }
  }
}

}  // namespace
}  // namespace sweepgrid::modes::engine_modes_test
