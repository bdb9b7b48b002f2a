// Calls from many threads.
#include <gtest/gtest.h>

#include <cstdint>
#include <span>
#include <stdexcept>
#include <thread>
#include <vector>

#include "engine_client.hpp"

namespace sweepgrid {
namespace {

TEST(EngineConcurrency, QueueingFromManyThreadsIsTheSameAsFromOne) {
  constexpr std::uint64_t kWorkers = 8;
  constexpr std::uint64_t kEach = oracle::kSanitized ? 150 : 400;
  for (const int threads : {1, 3}) {
    Config config;
    config.threads = threads;
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
}  // namespace sweepgrid
