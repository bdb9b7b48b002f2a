#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <sweepgrid/engine/config.hpp>
#include <sweepgrid/engine/object_table.hpp>
#include <sweepgrid/engine/stats.hpp>
#include <sweepgrid/engine/witness_table.hpp>
#include <sweepgrid/grid/grid.hpp>
#include <sweepgrid/grid/grid_fit.hpp>
#include <sweepgrid/scheduler/stage_graph.hpp>

namespace sweepgrid {

/// The engine without client keys: objects by id, and the step as a graph of stages. Engine adds keys and the order of
/// events. Not part of the public interface; compiled ahead for float and double in 2 and 3 dimensions.
template <class Scalar, int Dim>
class EngineCore {
 public:
  using BoxType = Box<Scalar, Dim>;
  using ConfigType = Config<Scalar, Dim>;
  using Objects = ObjectTable<Scalar, Dim>;

  /// Throws std::invalid_argument that names the setting.
  explicit EngineCore(ConfigType config);
  ~EngineCore();

  [[nodiscard]] Objects& objects() { return objects_; }
  [[nodiscard]] const Objects& objects() const { return objects_; }

  /// Where stages that follow `reduce` are added.
  [[nodiscard]] StageGraph& graph() { return *graph_; }
  [[nodiscard]] const StageGraph& graph() const { return *graph_; }
  [[nodiscard]] StageGraph::StageId last_stage() const { return reduce_stage_; }
  [[nodiscard]] const Executor& executor() const { return *executor_; }

  /// Runs the graph on what was queued, then lets erased ids be reused.
  void step();

  [[nodiscard]] std::size_t shards() const { return shards_.size(); }
  /// Of the latest step, by shard, in no order.
  [[nodiscard]] std::span<const PairKey> begins(std::size_t shard) const { return shards_[shard].begins; }
  [[nodiscard]] std::span<const PairKey> ends(std::size_t shard) const { return shards_[shard].ends; }
  [[nodiscard]] std::vector<PairKey> pairs() const;

  void validate() const;
  [[nodiscard]] Stats stats() const;

 private:
  using GridType = Grid<Scalar, Dim>;

  /// A block of objects as it is routed.
  struct RouteBlock {
    std::uint32_t first_granule = 0;
    std::uint32_t last_granule = 0;
    StepCounters counters;
    std::int64_t outside_change = 0;
    std::vector<ObjectId> retired;
  };

  /// Active cells that one task drains, and the deltas that come of it, sorted by shard.
  struct DrainTask {
    std::size_t group = 0;
    std::span<const typename GridType::ActiveCell> cells;
    std::vector<OverlapDelta> deltas;
    std::vector<OverlapDelta> by_shard;
    std::vector<std::size_t> shard_end;
    SapCounters counters;
  };

  struct Shard {
    WitnessTable witnesses;
    std::vector<PairKey> begins;
    std::vector<PairKey> ends;
  };

  void plan_route(std::vector<std::uint64_t>& costs);
  void route(std::size_t block);
  void route_object(std::size_t block, ObjectId object, RouteBlock& out);
  void plan_gather(std::vector<std::uint64_t>& costs);
  void plan_drain(std::vector<std::uint64_t>& costs);
  void drain(std::size_t task);
  void partition(DrainTask& task) const;
  void plan_reduce(std::vector<std::uint64_t>& costs);
  void reduce(std::size_t shard);
  void finish_step();

  [[nodiscard]] bool fixed_grid() const { return config_.cell_size && config_.bounds; }
  [[nodiscard]] bool outgrown() const;
  [[nodiscard]] bool crowded() const;
  [[nodiscard]] GridSpec<Scalar, Dim> derive_grid() const;
  void follow_scene();
  [[nodiscard]] std::size_t shard_of(PairKey pair) const { return WitnessTable::hash(pair) >> shard_shift_; }
  void validate_residents() const;
  void validate_witnesses() const;

  ConfigType config_;
  std::shared_ptr<Executor> executor_;
  Objects objects_;
  GridType grid_;

  /// What the grid was derived from, and what would make it worth deriving anew.
  bool gridded_ = false;
  std::size_t objects_at_fit_ = 0;
  std::int64_t outside_ = 0;
  std::int64_t outside_at_fit_ = 0;
  double crowding_ = 0;         // residents that the average op of the latest step met in its cell
  double crowding_at_fit_ = 0;  // the same when the grid was found to be as good as it gets

  bool idle_ = true;         // the latest step had nothing to do
  bool regridding_ = false;  // this step inserts every object into a new grid
  std::vector<RouteBlock> blocks_;
  std::vector<DrainTask> tasks_;
  std::vector<Shard> shards_;
  int shard_shift_ = 64;

  StepCounters counters_;
  StepCounters total_;
  std::uint64_t steps_ = 0;

  std::unique_ptr<StageGraph> graph_;
  StageGraph::StageId reduce_stage_ = 0;
};

extern template class EngineCore<float, 2>;
extern template class EngineCore<float, 3>;
extern template class EngineCore<double, 2>;
extern template class EngineCore<double, 3>;

}  // namespace sweepgrid
