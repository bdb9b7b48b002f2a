// What the engine takes of the heap: stats() counts it, warm steps ask for nothing, and what no step needs goes back.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine_client.hpp"
#include "watched_heap.hpp"

namespace sweepgrid::engine_heap_test {
namespace {

using Engine3 = Engine<float, 3>;
using Box3 = Box<float, 3>;

/// Boxes of width 1 in a lattice of that many on an edge, and as far apart; each object to and fro by a little.
class Lattice {
 public:
  explicit Lattice(int edge, float apart) : edge_(edge), apart_(apart) {}

  [[nodiscard]] std::uint64_t objects() const { return static_cast<std::uint64_t>(edge_) * edge_ * edge_; }
  [[nodiscard]] Box3 box(std::uint64_t object, int step) const {
    const auto place = [&](std::uint64_t at) { return static_cast<float>(at % edge_) * apart_; };
    const float shift = static_cast<float>(step % 2) / 4096;
    const float x = place(object) + shift;
    const float y = place(object / edge_);
    const float z = place(object / edge_ / edge_);
    return {{x, y, z}, {x + 1, y + 1, z + 1}};
  }

 private:
  int edge_;
  float apart_;
};

using oracle::NamedConfig;

/// Without the baselines, which allocate as they please.
std::vector<NamedConfig> settings() {
  auto all = oracle::all_configs();
  std::erase_if(all, [](const NamedConfig& named) {
    return named.config.cell.kind == CellKind::kClassic || named.config.cell.kind == CellKind::kPlane;
  });
  return all;
}

void insert_all(Engine3& engine, const Lattice& lattice) {
  for (std::uint64_t key = 0; key < lattice.objects(); ++key) engine.insert(key, lattice.box(key, 0));
  engine.step();
}

/// Moves every `stride`-th object.
void move(Engine3& engine, const Lattice& lattice, std::uint64_t stride, int step) {
  for (std::uint64_t key = 0; key < lattice.objects(); key += stride) engine.update(key, lattice.box(key, step));
}

/// Allocations of the calls of step() from the `first` one on. Those 64 steps after the insertion are not counted: then
/// what that took goes back.
std::int64_t allocations_of_steps(const Config& config, const Lattice& lattice, std::uint64_t stride, int first,
                                  int steps) {
  Engine3 engine(config);
  insert_all(engine, lattice);
  std::int64_t allocations = 0;
  for (int step = 1; step < steps; ++step) {
    move(engine, lattice, stride, step);
    const std::int64_t before = heap::allocations();
    engine.step();
    if (step >= first && (step < 60 || step > 70)) allocations += heap::allocations() - before;
    EXPECT_EQ(engine.stats().step.migrations, 0U);
  }
  return allocations;
}

TEST(Heap, AWarmStepWhoseObjectsStayInTheirCellsAllocatesNothing) {
  const Lattice apart(8, 1.5F);
  const Lattice close(8, 0.95F);  // each overlaps all around it, before and after
  for (NamedConfig& setting : settings()) {
    for (const StepMethod method : {StepMethod::kCells, StepMethod::kSweep}) {
      setting.config.step_method = method;
      for (const Lattice& lattice : {apart, close}) {
        for (const std::uint64_t stride : {1, 10}) {
          EXPECT_EQ(allocations_of_steps(setting.config, lattice, stride, 10, 150), 0)
              << setting.name << ", " << stride << ", method " << static_cast<int>(method);
        }
      }
    }
  }
}

TEST(Heap, NorDoesOneOfCrowdedCells) {
  const Lattice crowd(9, 1.5F);  // more objects in a cell than fit on the stack
  for (NamedConfig& setting : settings()) {
    setting.config.cell_size = 1000;
    setting.config.step_method = StepMethod::kCells;
    for (const std::uint64_t stride : {1, 10}) {
      EXPECT_EQ(allocations_of_steps(setting.config, crowd, stride, 5, 15), 0) << setting.name << ", " << stride;
    }
  }
}

TEST(Heap, NorDoesAnIdleStep) {
  Engine3 engine(serial());
  insert_all(engine, Lattice(8, 0.95F));
  const std::int64_t before = heap::allocations();
  for (int step = 0; step < 70; ++step) engine.step();
  EXPECT_EQ(heap::allocations(), before);
}

constexpr std::uint64_t kFlood = 400;  // objects, all at one point: 80000 pairs

/// Objects all at one point or each for itself.
class Flood {
 public:
  explicit Flood(const Config& config) : engine_(config) {
    for (std::uint64_t object = 0; object < kFlood; ++object) engine_.insert(object, box(object, false, 0));
    engine_.step();
  }

  void move(bool together, int turn = 0) {
    for (std::uint64_t object = 0; object < kFlood; ++object) {
      engine_.update(object, box(object, together, turn));
    }
    engine_.step();
  }
  void erase() {
    for (std::uint64_t object = 0; object < kFlood; ++object) engine_.erase(object);
    engine_.step();
  }
  void idle(int steps) {
    for (int step = 0; step < steps; ++step) engine_.step();
  }

 private:
  static Box3 box(std::uint64_t object, bool together, int turn) {
    const float x = together ? 0 : static_cast<float>(object) * 3 + static_cast<float>(turn % 2) * 0.125F;
    return {{x, 0, 0}, {x + 1, 1, 1}};
  }
  Engine3 engine_;
};

std::vector<NamedConfig> settings_on_threads() {
  std::vector<NamedConfig> all = settings();
  for (const NamedConfig& setting : settings()) {
    all.push_back(setting);
    all.back().name += ", 3 threads";
    all.back().config.executor = make_executor(3);
    all.back().config.parallel_from = 0;
  }
  return all;
}

TEST(Heap, WhatAFloodTookGoesBackAfter64Steps) {
  for (const NamedConfig& setting : settings_on_threads()) {
    const std::int64_t before = heap::bytes();
    Flood flood(setting.config);
    const std::int64_t calm = heap::bytes() - before;
    flood.move(true);
    EXPECT_GT(heap::bytes() - before, 10 * calm) << setting.name;
    flood.move(false);
    flood.idle(66);
    EXPECT_LT(heap::bytes() - before, 2 * calm) << setting.name << ", idle";
    flood.move(true);
    for (int turn = 0; turn < 66; ++turn) flood.move(false, turn);
    EXPECT_LT(heap::bytes() - before, 2 * calm) << setting.name << ", moving";
    flood.erase();
    flood.idle(66);
    EXPECT_LT(heap::bytes() - before, calm / 2) << setting.name << ", erased";
  }
}

}  // namespace
}  // namespace sweepgrid::engine_heap_test
