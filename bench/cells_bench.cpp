// Cells by themselves: what a drain costs by kind, population and share of movers. The thresholds between local and
// global sorts, the default segment capacity and the populations at which kinds change over come from here.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <memory>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <sweepgrid/sap/cell_kind.hpp>

namespace {

using namespace sweepgrid;
using Op = CellOp<float, 3>;

/// The paper's workload (section 4) in one cell: unit cubes at 5 % density that move by a tenth of their width.
class World {
 public:
  explicit World(std::size_t objects, unsigned seed = 1)
      : side_(std::cbrt(static_cast<float>(objects) / 0.05F)), random_(seed) {
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

  [[nodiscard]] Op op(ObjectId object, OpKind kind, float width = 1) const {
    Box<float, 3> box;
    for (int axis = 0; axis < 3; ++axis) {
      box.min[axis] = bodies_[object].corner[axis];
      box.max[axis] = bodies_[object].corner[axis] + width;
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
  std::mt19937 random_;
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
  DeltaList deltas;
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

double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Cells of one kind and population, about a thousand objects in all.
class Cells {
 public:
  Cells(CellKind kind, std::size_t population) {
    for (unsigned cell = 0; cell < std::max<std::size_t>(1, 1000 / population); ++cell) {
      worlds_.emplace_back(population, cell + 1);
      cells_.push_back(make_cell<float, 3>({kind}));
      std::vector<Op> ops;
      for (ObjectId object = 0; object < population; ++object) ops.push_back(worlds_[cell].op(object, OpKind::kInsert));
      cells_[cell]->drain(ops, deltas_, counters_);
    }
  }

  /// Moves so many random objects in each cell, for `rounds` times, and returns how long the drains took.
  double move(std::size_t movers, int rounds) {
    ops_.clear();
    std::vector<ObjectId> objects(worlds_[0].size());
    for (ObjectId object = 0; object < objects.size(); ++object) objects[object] = object;
    for (int round = 0; round < rounds; ++round) {
      for (World& world : worlds_) {
        std::shuffle(objects.begin(), objects.end(), random_);
        for (std::size_t i = 0; i < movers; ++i) {
          world.move(objects[i]);
          ops_.push_back(world.op(objects[i], OpKind::kUpdate));
        }
      }
    }
    deltas_.clear();
    const double begin = thread_seconds();
    std::span<const Op> rest = ops_;
    for (int round = 0; round < rounds; ++round) {
      for (const auto& cell : cells_) {
        cell->drain(rest.first(movers), deltas_, counters_);
        rest = rest.subspan(movers);
      }
    }
    return thread_seconds() - begin;
  }

  /// Has `visitors` objects three times as wide as the residents come by in each cell.
  double visit(std::size_t visitors, int rounds) {
    std::vector<Visit> visits;
    for (std::size_t i = 0; i < cells_.size() * static_cast<std::size_t>(rounds) * visitors; ++i) {
      World visitor(worlds_[0].size(), static_cast<unsigned>(i));
      const auto before = visitor.op(0, OpKind::kUpdate, 3).box;
      visitor.move(0);
      visits.push_back({kNoObject - 1, true, true, before, visitor.op(0, OpKind::kUpdate, 3).box});
    }
    deltas_.clear();
    const double begin = thread_seconds();
    std::span<const Visit> rest = visits;
    for (int round = 0; round < rounds; ++round) {
      for (const auto& cell : cells_) {
        cell->visit(rest.first(visitors), deltas_, counters_);
        rest = rest.subspan(visitors);
      }
    }
    return thread_seconds() - begin;
  }

  [[nodiscard]] std::size_t size() const { return cells_.size(); }

 private:
  using Visit = SweepAndPrune<float, 3>::Visit;
  std::vector<World> worlds_;
  std::vector<std::unique_ptr<SweepAndPrune<float, 3>>> cells_;
  std::mt19937 random_{1};
  std::vector<Op> ops_;
  DeltaList deltas_;
  SapCounters counters_;
};

constexpr int kRounds = 16;

void report_ops(benchmark::State& state, std::size_t ops_per_iteration) {
  const auto ops = static_cast<double>(ops_per_iteration) * 1e-9;
  state.counters["ns_per_op"] =
      benchmark::Counter(ops, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// Arguments: kind, objects, movers per thousand (at least one moves). Warm: all cells together fit into the L2 cache.
void population(benchmark::State& state) {
  const auto objects = static_cast<std::size_t>(state.range(1));
  const std::size_t movers = std::max<std::size_t>(1, objects * static_cast<std::size_t>(state.range(2)) / 1000);
  Cells cells(static_cast<CellKind>(state.range(0)), objects);
  for (auto _ : state) state.SetIterationTime(cells.move(movers, kRounds));
  report_ops(state, cells.size() * movers * kRounds);
}

// Arguments: kind, objects, visitors at a time.
void visit(benchmark::State& state) {
  const auto visitors = static_cast<std::size_t>(state.range(2));
  Cells cells(static_cast<CellKind>(state.range(0)), static_cast<std::size_t>(state.range(1)));
  for (auto _ : state) state.SetIterationTime(cells.visit(visitors, kRounds));
  report_ops(state, cells.size() * visitors * kRounds);
}

constexpr std::int64_t kRows = static_cast<std::int64_t>(CellKind::kRows);
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

BENCHMARK(population)
    ->ArgNames({"kind", "n", "moving"})
    ->ArgsProduct({{kRows, kBatch, kSegmented}, {4, 8, 10, 16, 32, 64, 128, 300, 1000, 3000}, {100, 300, 1000}})
    ->UseManualTime();
BENCHMARK(visit)->ArgNames({"kind", "n", "visitors"})->ArgsProduct({{kRows}, {4, 10, 16, 64}, {1, 4}})->UseManualTime();

}  // namespace
