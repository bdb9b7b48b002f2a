// Calls from many threads.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <thread>
#include <vector>

#include <sweepgrid/scheduler/executor.hpp>

#include "engine_client.hpp"

namespace sweepgrid::engine_concurrency_test {
namespace {

TEST(EngineConcurrency, QueueingFromManyThreadsIsTheSameAsFromOne) {
  constexpr std::uint64_t kWorkers = 8;
  constexpr std::uint64_t kEach = oracle::kSanitized ? 150 : 400;
  for (const int threads : {1, 3}) {
    Config config;
    config.threads = threads;
    config.parallel_from = 0;
    Engine2 engine(config);
    oracle::EngineModel<float, 2> model;
    for (std::uint64_t step = 0; step < 6; ++step) {
      const auto box_of = [&](std::uint64_t key) {
        oracle::Random random(1000 * step + key);
        return square(static_cast<float>(random.below(1000)) / 10, static_cast<float>(random.below(1000)) / 10);
      };
      const auto each = [&](std::uint64_t worker, const auto& insert, const auto& update, const auto& erase) {
        for (std::uint64_t i = 0; i < kEach; ++i) {
          const std::uint64_t key = i * kWorkers + worker;  // neighbours belong to different threads
          const std::uint64_t phase = (key / kWorkers + step) % 5;
          if (step == 0)
            insert(key, box_of(key));
          else if (phase == 1)
            erase(key);
          else if (phase == 2 && step > 1)
            insert(key, box_of(key));
          else if (phase != 2)
            update(key, box_of(key));
        }
      };
      std::vector<std::thread> workers;
      for (std::uint64_t worker = 0; worker < kWorkers; ++worker) {
        workers.emplace_back([&, worker] {
          each(
              worker, [&](auto key, const Box2& box) { engine.insert(key, box); },
              [&](auto key, const Box2& box) { engine.update(key, box); }, [&](auto key) { engine.erase(key); });
        });
      }
      for (std::thread& worker : workers) worker.join();
      for (std::uint64_t worker = 0; worker < kWorkers; ++worker) {
        each(
            worker, [&](auto key, const Box2& box) { model.insert(key, box); },
            [&](auto key, const Box2& box) { model.update(key, box); }, [&](auto key) { model.erase(key); });
      }
      ASSERT_EQ(oracle::difference(model.step(), engine.step()), "") << "step " << step;
      ASSERT_EQ(oracle::compare(engine, model), "") << "step " << step;
    }
  }
}

/// Does all by itself, and calls back before each loop.
class Talkative final : public Executor {
 public:
  [[nodiscard]] int concurrency() const override { return 1; }
  [[nodiscard]] int worker() const override { return 0; }
  void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override {
    if (call) call();
    for (std::size_t i = 0; i < count; ++i) body(i);
  }
  void execute(const std::function<void()>& work) override { work(); }
  std::function<void()> call;
};

TEST(EngineConcurrency, CallsDuringAStepAreRefused) {
  const auto executor = std::make_shared<Talkative>();
  Config config;
  config.executor = executor;
  Engine2 engine(config);
  const Handle first = engine.insert(1, square(0, 0));
  engine.insert(2, square(0, 0));
  int refused = 0;
  executor->call = [&] {
    const auto expect_refused = [&](const std::function<void()>& call) {
      EXPECT_THROW(call(), std::logic_error);
      ++refused;
    };
    const std::vector<Handle> handles{first};
    const std::vector<Box2> boxes{square(1, 1)};
    expect_refused([&] { engine.insert(3, square(0, 0)); });
    expect_refused([&] { engine.insert(std::vector<std::uint64_t>{3}, boxes); });
    expect_refused([&] { engine.update(first, square(3, 3)); });
    expect_refused([&] { engine.update(1, square(3, 3)); });
    expect_refused([&] { engine.update(handles, boxes); });
    expect_refused([&] { engine.erase(first); });
    expect_refused([&] { engine.erase(1); });
    expect_refused([&] { engine.erase(handles); });
    expect_refused([&] { engine.step(); });
    expect_refused([&] { static_cast<void>(engine.pairs()); });
    expect_refused([&] { static_cast<void>(engine.box(first)); });
    expect_refused([&] { static_cast<void>(engine.contains(1)); });
    expect_refused([&] { static_cast<void>(engine.size()); });
    expect_refused([&] { static_cast<void>(engine.stats()); });
    expect_refused([&] { engine.validate(); });
  };
  EXPECT_EQ(engine.step().begins, (Pairs{{1, 2}}));
  EXPECT_GE(refused, 15);
  executor->call = nullptr;
  EXPECT_EQ(engine.size(), 2u);
  EXPECT_TRUE(engine.step().begins.empty());
  engine.validate();
}

TEST(EngineConcurrency, StaleHandlesAreRefusedWhileTheirSlotsAreReused) {
  constexpr int kRounds = oracle::kSanitized ? 20 : 60;
  constexpr std::uint64_t kObjects = 400;
  Engine2 engine(serial());
  std::vector<Handle> stale;
  std::vector<Handle> live;
  for (int round = 0; round < kRounds; ++round) {
    for (const Handle handle : live) engine.erase(handle);
    engine.step();
    stale = live;
    live.clear();
    std::thread stranger([&engine, stale] {
      const std::vector<Box2> boxes(stale.size(), square(5, 5));
      for (const Handle handle : stale) {
        EXPECT_THROW(engine.update(handle, square(5, 5)), std::invalid_argument);
        EXPECT_THROW(engine.erase(handle), std::invalid_argument);
      }
      if (stale.empty()) return;
      EXPECT_THROW(engine.update(stale, boxes), std::invalid_argument);
      EXPECT_THROW(engine.erase(stale), std::invalid_argument);
    });
    const std::uint64_t count =
        round % 3 == 0 ? kObjects / 8 : kObjects;  // sometimes slots at the top go, and come back
    for (std::uint64_t key = 0; key < count; ++key) {
      live.push_back(engine.insert(key, square(static_cast<float>(2 * key), 0)));
      engine.update(live.back(), square(static_cast<float>(2 * key), 1));
    }
    stranger.join();
    engine.step();
    EXPECT_EQ(engine.size(), count);
    for (std::uint64_t key = 0; key < count; ++key) {
      ASSERT_EQ(engine.box(live[key]), square(static_cast<float>(2 * key), 1));
    }
  }
}

TEST(EngineConcurrency, BulkCallsFromManyThreads) {
  Engine2 engine(serial());
  oracle::EngineModel<float, 2> model;
  std::vector<std::thread> workers;
  for (std::uint64_t worker = 0; worker < 4; ++worker) {
    workers.emplace_back([&engine, worker] {
      std::vector<std::uint64_t> keys;
      std::vector<Box2> boxes;
      for (std::uint64_t i = 0; i < 300; ++i) {
        keys.push_back(i * 4 + worker);
        boxes.push_back(square(static_cast<float>(keys.back() % 40), static_cast<float>(keys.back() / 40)));
      }
      const std::vector<Handle> handles = engine.insert(keys, boxes);
      EXPECT_THROW(engine.insert(keys, boxes), std::invalid_argument);
      for (Box2& box : boxes) box.max[0] += 0.5F;
      engine.update(handles, boxes);
      engine.erase(std::span(handles).subspan(0, 50));
    });
  }
  for (std::thread& worker : workers) worker.join();
  for (std::uint64_t key = 200; key < 1200; ++key) {
    Box2 box = square(static_cast<float>(key % 40), static_cast<float>(key / 40));
    box.max[0] += 0.5F;
    model.insert(key, box);
  }
  ASSERT_EQ(oracle::difference(model.step(), engine.step()), "");
  ASSERT_EQ(oracle::compare(engine, model), "");
}

}  // namespace
}  // namespace sweepgrid::engine_concurrency_test
