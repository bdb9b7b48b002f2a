// One cell by itself: what a drain costs by kind, population and share of movers. The thresholds between local and
// global sorts and the default segment capacity come from here.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include <sweepgrid/sap/cell_kind.hpp>

namespace {

using namespace sweepgrid;
using Op = CellOp<float, 3>;

/// The paper's workload (section 4) in one cell: unit cubes at 5 % density that move by a tenth of their width.
class World {
 public:
  explicit World(std::size_t objects) : side_(std::cbrt(static_cast<float>(objects) / 0.05F)) {
    std::uniform_real_distribution<float> place(0, side_);
    std::normal_distribution<float> direction;
    for (std::size_t i = 0; i < objects; ++i) {
      Body body{};
      float norm = 0;
      for (int axis = 0; axis < 3; ++axis) {
        body.corner[axis] = place(random_);
        body.velocity[axis] = direction(random_);
        norm += body.velocity[axis] * body.velocity[axis];
      }
      for (float& v : body.velocity) v *= 0.1F / std::sqrt(norm);
      bodies_.push_back(body);
    }
  }

  [[nodiscard]] std::size_t size() const { return bodies_.size(); }

  [[nodiscard]] Op op(ObjectId object, OpKind kind) const {
    Box<float, 3> box;
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] = bodies_[object].corner[axis];
      box.max[axis] = bodies_[object].corner[axis] + 1;
    }
    return {object, kind, OrderedBox<float, 3>(box)};
  }

  void move(ObjectId object) {
    Body& body = bodies_[object];
    for (int axis = 0; axis < 3; ++axis) {
      float& corner = body.corner[axis];
      if (corner + body.velocity[axis] < 0 || corner + body.velocity[axis] > side_) body.velocity[axis] *= -1;
      corner += body.velocity[axis];
    }
  }

 private:
  struct Body {
    float corner[3];
    float velocity[3];
  };
  float side_;
  std::mt19937 random_{1};
  std::vector<Body> bodies_;
};

// Arguments: kind, objects, movers per thousand, objects erased and inserted again per drain, segment capacity.
void drain(benchmark::State& state) {
  const auto kind = static_cast<CellKind>(state.range(0));
  World world(static_cast<std::size_t>(state.range(1)));
  const auto movers = static_cast<std::size_t>(state.range(1) * state.range(2) / 1000);
  const auto churn = static_cast<std::size_t>(state.range(3));
  const auto cell = make_cell<float, 3>({kind, static_cast<int>(state.range(4))});
  std::vector<Op> ops;
  std::vector<OverlapDelta> deltas;
  SapCounters counters;
  for (ObjectId object = 0; object < world.size(); ++object) ops.push_back(world.op(object, OpKind::kInsert));
  cell->drain(ops, deltas, counters);
  counters = SapCounters{};
  std::vector<ObjectId> out;  // erased in one drain, inserted in the next
  std::vector<char> busy(world.size());
  ObjectId next = 0;
  for (auto _ : state) {
    state.PauseTiming();
    ops.clear();
    std::fill(busy.begin(), busy.end(), 0);
    for (const ObjectId object : std::exchange(out, {})) {
      ops.push_back(world.op(object, OpKind::kInsert));
      busy[object] = 1;
    }
    for (std::size_t i = 0; i < churn; ++i) {
      next = (next + 7) % static_cast<ObjectId>(world.size());
      if (std::exchange(busy[next], 1) != 0) continue;
      ops.push_back(world.op(next, OpKind::kErase));
      out.push_back(next);
    }
    for (ObjectId object = 0; object < movers; ++object) {
      if (busy[object] != 0) continue;
      world.move(object);
      ops.push_back(world.op(object, OpKind::kUpdate));
    }
    deltas.clear();
    state.ResumeTiming();
    cell->drain(ops, deltas, counters);
  }
  const auto per_drain = [&](std::uint64_t count) {
    return benchmark::Counter(static_cast<double>(count), benchmark::Counter::kAvgIterations);
  };
  state.counters["swaps"] = per_drain(counters.swaps);
  state.counters["box_tests"] = per_drain(counters.box_tests);
  state.counters["deltas"] = per_drain(counters.deltas);
  state.counters["global"] = per_drain(counters.global_sorts);
}

constexpr std::int64_t kBatch = static_cast<std::int64_t>(CellKind::kBatch);
constexpr std::int64_t kSegmented = static_cast<std::int64_t>(CellKind::kSegmented);
constexpr std::int64_t kClassic = static_cast<std::int64_t>(CellKind::kClassic);
constexpr std::int64_t kPlane = static_cast<std::int64_t>(CellKind::kPlane);

BENCHMARK(drain)
    ->ArgNames({"kind", "n", "moving", "churn", "capacity"})
    ->ArgsProduct({{kBatch, kSegmented, kClassic, kPlane}, {50, 300}, {100, 1000}, {0, 1}, {32}})
    ->ArgsProduct({{kBatch, kSegmented}, {50, 300, 3000}, {20, 50, 100, 200, 300, 500, 700, 1000}, {0}, {32}})
    ->ArgsProduct({{kBatch}, {50, 300}, {100, 1000}, {1, 2, 4, 6, 8, 12}, {32}})
    ->ArgsProduct({{kSegmented}, {300, 3000}, {50, 200, 1000}, {1}, {8, 16, 32, 48, 64, 128}});

}  // namespace
