#include "study/figures/system.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include <sweepgrid/engine/engine.hpp>

#include "baselines/dynamic_octree.hpp"

namespace sweepgrid::study {
namespace {

/// One cell by itself.
class CellSystem final : public System {
 public:
  explicit CellSystem(const SystemSpec& spec)
      : pieces_(static_cast<std::size_t>(spec.pieces)), cell_(make_cell<float, 3>(spec.cell)) {}

  void step(const ScriptStep& changes) override {
    ops_.clear();
    for (const std::uint32_t object : changes.erased) ops_.push_back({object, OpKind::kErase, {}});
    append(OpKind::kInsert, changes.inserted, changes.inserted_boxes);
    append(OpKind::kUpdate, changes.updated, changes.updated_boxes);
    deltas_.clear();
    std::span<const Op> rest = ops_;
    for (std::size_t left = pieces_; left > 0; --left) {
      const std::size_t count = (rest.size() + left - 1) / left;
      cell_->drain(rest.first(count), deltas_, work_.cells);
      rest = rest.subspan(count);
    }
    work_.updates += changes.updated.size();
  }

  void settle() override {
    for (const OverlapDelta& delta : deltas_) all_deltas_.emplace_back(delta.pair, delta.change);
  }

  [[nodiscard]] std::vector<PairKey> pairs() override {
    std::sort(all_deltas_.begin(), all_deltas_.end());
    std::vector<PairKey> result;
    for (auto delta = all_deltas_.begin(); delta != all_deltas_.end();) {
      const PairKey pair = delta->first;
      std::int64_t sum = 0;
      for (; delta != all_deltas_.end() && delta->first == pair; ++delta) sum += delta->second;
      // A sum other than 0 and 1 must not pass for a pair.
      for (std::int64_t i = 0; i < std::abs(sum); ++i) result.push_back(pair);
    }
    return result;
  }

  [[nodiscard]] Work work() const override { return work_; }

 private:
  using Op = CellOp<float, 3>;

  void append(OpKind kind, const std::vector<std::uint32_t>& objects, const std::vector<FloatBox>& boxes) {
    for (std::size_t i = 0; i < objects.size(); ++i) {
      ops_.push_back({objects[i], kind, OrderedBox<float, 3>(boxes[i])});
    }
  }

  std::size_t pieces_;
  std::unique_ptr<SweepAndPrune<float, 3>> cell_;
  std::vector<Op> ops_;
  DeltaList deltas_;
  std::vector<std::pair<PairKey, std::int32_t>> all_deltas_;
  Work work_;
};

/// The engine, as a client uses it: by handle and in bulk.
class EngineSystem final : public System {
 public:
  EngineSystem(const Config& config, std::uint32_t numbers) : engine_(config), handles_(numbers) {}

  void step(const ScriptStep& changes) override {
    engine_.erase(handles_of(changes.erased));
    const std::vector<Handle> inserted =
        engine_.insert(std::span<const std::uint32_t>(changes.inserted), std::span(changes.inserted_boxes));
    for (std::size_t i = 0; i < inserted.size(); ++i) handles_[changes.inserted[i]] = inserted[i];
    engine_.update(handles_of(changes.updated), std::span(changes.updated_boxes));
    engine_.step();
  }

  [[nodiscard]] std::vector<PairKey> pairs() override {
    std::vector<PairKey> result;
    for (const auto& [first, second] : engine_.pairs()) result.emplace_back(first, second);
    return result;
  }

  [[nodiscard]] Work work() const override {
    const StepCounters total = engine_.stats().total;
    return {total.cells, total.updates, total.cell_ops, total.cells_drained, total.begins + total.ends};
  }

 private:
  std::span<const Handle> handles_of(const std::vector<std::uint32_t>& objects) {
    chosen_.clear();
    for (const std::uint32_t object : objects) chosen_.push_back(handles_[object]);
    return chosen_;
  }

  Engine<float, 3, std::uint32_t> engine_;
  std::vector<Handle> handles_;  // by object number
  std::vector<Handle> chosen_;
};

/// The baseline, told as the engine is.
class OctreeSystem final : public System {
 public:
  void step(const ScriptStep& changes) override {
    for (const std::uint32_t object : changes.erased) octree_.erase(object);
    for (std::size_t i = 0; i < changes.inserted.size(); ++i) {
      octree_.insert(changes.inserted[i], changes.inserted_boxes[i]);
    }
    for (std::size_t i = 0; i < changes.updated.size(); ++i) {
      octree_.update(changes.updated[i], changes.updated_boxes[i]);
    }
    events_ = &octree_.step();
    work_.updates += changes.updated.size();
    work_.events += events_->begins.size() + events_->ends.size();
    work_.cells.box_tests = octree_.counters().box_tests;
  }

  void settle() override {
    for (const Pair<ObjectId>& pair : events_->ends) pairs_.erase(PairKey(pair.first, pair.second));
    for (const Pair<ObjectId>& pair : events_->begins) pairs_.insert(PairKey(pair.first, pair.second));
  }

  [[nodiscard]] std::vector<PairKey> pairs() override { return {pairs_.begin(), pairs_.end()}; }
  [[nodiscard]] Work work() const override { return work_; }

 private:
  baselines::DynamicOctree<float> octree_;
  const Events<ObjectId>* events_ = nullptr;
  std::set<PairKey> pairs_;
  Work work_;
};

Config grid_config(const SystemSpec& spec, const Script& script) {
  Config config;
  config.cell = spec.cell;
  config.reduction = Reduction::kWitnessCounts;
  config.cell_size = grid_cell_size(spec.population, script);
  config.threads = 1;
  return config;
}

}  // namespace

double grid_cell_size(double population, const Script& script) {
  // A unit cube reaches into a cell from as far as its width beyond one side.
  const double ideal = std::cbrt(population / script.mean_density) - 1;
  const double cells = std::max(1.0, std::round(script.world_edge / std::max(ideal, 0.5)));
  // Rounding must not open a last row of cells that holds next to nothing.
  return script.world_edge / cells * (1 + 1e-6);
}

std::unique_ptr<System> make_system(const SystemSpec& spec, const Script& script) {
  Config engine_defaults;
  engine_defaults.threads = 1;
  switch (spec.layout) {
    case Layout::kOneCell:
      return std::make_unique<CellSystem>(spec);
    case Layout::kGrid:
      return std::make_unique<EngineSystem>(grid_config(spec, script), script.numbers);
    case Layout::kEngine:
      return std::make_unique<EngineSystem>(engine_defaults, script.numbers);
    case Layout::kOctree:
      return std::make_unique<OctreeSystem>();
  }
  throw std::invalid_argument("make_system: unknown layout");
}

}  // namespace sweepgrid::study
