// What the public interface promises beside the right events: handles, keys and boxes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine_client.hpp"

namespace sweepgrid::engine_api_test {
namespace {

static_assert(!std::is_copy_constructible_v<Engine2> && std::is_nothrow_move_constructible_v<Engine2> &&
              std::is_nothrow_move_assignable_v<Engine2>);

TEST(Engine, CanBeMoved) {
  std::vector<Engine2> engines;
  engines.emplace_back(serial());
  engines[0].insert(1, square(0, 0));
  const Handle second = engines[0].insert(2, square(0, 0));
  const auto& events = engines[0].step();
  ASSERT_EQ(events.begins, (Pairs{{1, 2}}));
  for (int i = 0; i < 10; ++i) engines.emplace_back(serial());  // moves the first
  EXPECT_EQ(events.begins, (Pairs{{1, 2}}));
  engines[5] = std::move(engines[0]);
  EXPECT_EQ(events.begins, (Pairs{{1, 2}}));
  engines[5].update(second, square(9, 9));
  EXPECT_EQ(engines[5].step().ends, (Pairs{{1, 2}}));
  EXPECT_GT(engines[5].stats().bytes(), 0u);
  engines[5].validate();
}

TEST(Engine, HandlesAreGoodAtOnceAndBoxesAreTheLastGiven) {
  Engine2 engine(serial());
  const Handle handle = engine.insert(5, square(0, 0));
  EXPECT_EQ(engine.key(handle), 5u);
  EXPECT_EQ(engine.box(handle), square(0, 0));
  EXPECT_EQ(engine.find(5), handle);
  engine.update(handle, square(1, 1));
  EXPECT_EQ(engine.box(handle), square(1, 1));
  engine.step();
  EXPECT_EQ(engine.box(handle), square(1, 1));
  engine.update(handle, square(2, 2));
  EXPECT_EQ(engine.box(handle), square(2, 2));
}

TEST(Engine, BulkInsertReturnsHandlesInOrder) {
  Engine2 engine(serial());
  const std::vector<std::uint64_t> keys{9, 3, 7};
  const auto handles = engine.insert(keys, std::vector<Box2>(3, square(0, 0)));
  ASSERT_EQ(handles.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(engine.key(handles[i]), keys[i]);
}

TEST(Engine, SizeCountsWhatIsQueued) {
  Engine2 engine(serial());
  engine.insert(1, square(0, 0));
  engine.insert(2, square(0, 0));
  EXPECT_EQ(engine.size(), 2u);
  engine.step();
  engine.erase(std::uint64_t{1});
  EXPECT_EQ(engine.size(), 1u);
  EXPECT_FALSE(engine.contains(1));
  engine.insert(1, square(0, 0));
  EXPECT_EQ(engine.size(), 2u);
}

TEST(Engine, PairsAreThoseOfTheLatestStepWhateverIsQueued) {
  Engine2 engine(serial());
  for (const std::uint64_t key : {3, 1, 2}) engine.insert(key, square(0, 0));
  engine.step();
  const Pairs pairs{{1, 2}, {1, 3}, {2, 3}};
  EXPECT_EQ(engine.pairs(), pairs);
  engine.erase(std::uint64_t{1});
  engine.update(std::uint64_t{2}, square(50, 50));
  engine.insert(1, square(90, 90));
  engine.insert(0, square(0, 0));
  EXPECT_EQ(engine.pairs(), pairs);
}

TEST(Engine, AKeyThatIsErasedAndInsertedEndsItsOldPairsAndBeginsItsNew) {
  Engine2 engine(serial());
  for (const std::uint64_t key : {1, 2, 3}) engine.insert(key, square(key == 3 ? 9.0F : 0.0F, 0));
  engine.step();
  const Handle old = engine.find(1).value();
  engine.erase(old);
  const Handle renewed = engine.insert(1, square(0, 0));
  EXPECT_NE(old, renewed);
  const auto& events = engine.step();
  EXPECT_EQ(events.ends, (Pairs{{1, 2}}));
  EXPECT_EQ(events.begins, (Pairs{{1, 2}}));
  engine.validate();
}

TEST(Engine, AnObjectThatLivesForNoStepLeavesNoTrace) {
  Engine2 engine(through_cells());
  engine.insert(1, square(0, 0));
  engine.step();
  engine.insert(2, square(0, 0));
  engine.update(std::uint64_t{2}, square(0.5F, 0));
  engine.erase(std::uint64_t{2});
  EXPECT_EQ(engine.step(), Events<std::uint64_t>{});
  const StepCounters& counters = engine.stats().step;
  EXPECT_EQ(counters.inserts + counters.updates + counters.erases + counters.cell_ops, 0u);
  engine.validate();
}

TEST(Engine, EventsStayUntilTheNextStep) {
  Engine2 engine(serial());
  engine.insert(1, square(0, 0));
  engine.insert(2, square(0, 0));
  const auto& events = engine.step();
  const auto copy = events;
  engine.erase(std::uint64_t{1});
  engine.insert(3, square(0, 0));

  EXPECT_EQ(events, copy);
  EXPECT_EQ(&engine.step(), &events);
  EXPECT_EQ(events.ends, (Pairs{{1, 2}}));
  EXPECT_EQ(events.begins, (Pairs{{2, 3}}));
  EXPECT_EQ(engine.step(), Events<std::uint64_t>{});
}

TEST(Engine, BoxesThatTouchOverlap) {
  Engine2 engine(serial());
  engine.insert(1, Box2({0, 0}, {1, 1}));
  engine.insert(2, Box2({1, 1}, {2, 2}));
  engine.insert(3, Box2({1, std::nextafter(1.0F, 2.0F)}, {1, 2}));
  engine.insert(4, Box2({-0.0F, -0.0F}, {-0.0F, -0.0F}));
  EXPECT_EQ(engine.step().begins, (Pairs{{1, 2}, {1, 4}, {2, 3}}));
}

TEST(Engine, EmptyBulkCallsDoNothing) {
  Engine2 engine(serial());
  EXPECT_TRUE(engine.insert(std::span<const std::uint64_t>(), std::span<const Box2>()).empty());
  engine.update(std::span<const Handle>(), std::span<const Box2>());
  engine.erase(std::span<const Handle>());
  EXPECT_EQ(engine.step(), Events<std::uint64_t>{});
}

}  // namespace
}  // namespace sweepgrid::engine_api_test
