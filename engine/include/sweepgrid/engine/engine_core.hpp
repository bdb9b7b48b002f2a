#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <sweepgrid/engine/config.hpp>
#include <sweepgrid/engine/method_choice.hpp>
#include <sweepgrid/engine/object_table.hpp>
#include <sweepgrid/engine/regrid.hpp>
#include <sweepgrid/engine/reporter.hpp>
#include <sweepgrid/engine/scene_sweep.hpp>
#include <sweepgrid/engine/stats.hpp>
#include <sweepgrid/engine/step_items.hpp>
#include <sweepgrid/engine/step_list.hpp>
#include <sweepgrid/engine/step_tasks.hpp>
#include <sweepgrid/engine/witness_table.hpp>
#include <sweepgrid/grid/grid_fit.hpp>
#include <sweepgrid/grid/levels.hpp>
#include <sweepgrid/sap/cell_kind.hpp>
#include <sweepgrid/sap/step_budget.hpp>
#include <sweepgrid/scheduler/stage_graph.hpp>

namespace sweepgrid {

/// The engine without client keys: objects by id, and the step as a graph of stages. Engine adds keys and the order of
/// events. Not part of the public interface.
template <class Scalar, int Dim>
class EngineCore {
 public:
  using BoxType = Box<Scalar, Dim>;
  using Objects = ObjectTable<Scalar, Dim>;

  /// Throws std::invalid_argument that names the setting. `event_bytes`: what the lists of an event take in all.
  EngineCore(Config config, std::size_t event_bytes);
  ~EngineCore();

  [[nodiscard]] Objects& objects() { return objects_; }
  [[nodiscard]] const Objects& objects() const { return objects_; }

  /// Where stages that follow `reduce` are added.
  [[nodiscard]] StageGraph& graph() { return *graph_; }
  [[nodiscard]] const StageGraph& graph() const { return *graph_; }
  [[nodiscard]] StageGraph::StageId last_stage() const { return reduce_stage_; }
  [[nodiscard]] Executor& executor() const { return *executor_; }

  /// Runs the graph on what was queued, then lets erased ids be reused. Returns false when that is over the budget;
  /// then, and when it throws, everything is as before: ops queued, pairs those of the latest step that was done. Also
  /// ends the step for all lists that are kept from step to step.
  [[nodiscard]] bool step();
  /// The same in two parts, for those who can fail between them: what run_step() has done, unless it returned false or
  /// threw, is made the latest step by commit_step(), or is taken back by cancel_step().
  [[nodiscard]] bool run_step();
  void commit_step() noexcept;
  void cancel_step() noexcept;
  void set_step_bytes(std::optional<std::uint64_t> bytes) { config_.step_bytes = bytes; }

  /// The events of the latest step come in lists, in no order; with single reporters a list may name a pair twice.
  [[nodiscard]] std::size_t lists() const {
    return sweeping_ ? sweep_.lists() : counting() ? shards_.size() : tasks_.size();
  }
  [[nodiscard]] std::span<const PairKey> begins(std::size_t list) const {
    if (sweeping_) return sweep_.begins(list);
    return counting() ? shards_[list].begins.items : tasks_[list].begins.items;
  }
  [[nodiscard]] std::span<const PairKey> ends(std::size_t list) const {
    if (sweeping_) return sweep_.ends(list);
    return counting() ? shards_[list].ends.items : tasks_[list].ends.items;
  }
  /// To be told the numbers of events once they are free of doubles.
  void count_events(std::size_t begins, std::size_t ends);
  /// Pairs by the events of all steps so far.
  [[nodiscard]] std::size_t pair_count() const { return pairs_; }

  /// In no order. Without cells by sweeping all boxes, O(n log n) and more.
  [[nodiscard]] std::vector<PairKey> pairs() const;

  void validate() const;
  [[nodiscard]] Stats stats() const;

 private:
  using GridType = Grid<Scalar, Dim>;
  using LevelsType = Levels<Scalar, Dim>;
  using Record = typename Objects::Record;
  // With witness counts: cells of a given size, and of a derived size beside one for each object.
  static constexpr double kMaxCells = double{1 << 24};
  static constexpr double kFewCells = 4096;

  using RouteBlock = step_tasks::Route;
  using GatherTask = step_tasks::Gather;
  using DrainTask = step_tasks::Drain<Scalar, Dim>;
  using Shard = step_tasks::Shard;

  [[nodiscard]] bool counting() const { return config_.reduction == Reduction::kWitnessCounts; }

  void prepare_step();
  [[nodiscard]] bool little_to_do() const;
  [[nodiscard]] std::size_t workers() const;
  [[nodiscard]] std::size_t worker() const;
  void plan_bin(std::vector<std::uint64_t>& costs);
  void bin(std::size_t block);
  void plan_sweep(std::vector<std::uint64_t>& costs);
  void sweep(std::size_t part);
  [[nodiscard]] bool choose_sweep();
  [[nodiscard]] std::size_t estimated_changes() const;
  void plan_route(std::vector<std::uint64_t>& costs);
  void route(std::size_t block);
  void route_granule(std::size_t block, std::uint32_t granule);
  void route_object(std::size_t block, ObjectId object, Record& record, RouteBlock& out);
  void note_change(Record& record, std::uint8_t state) const;
  void route_moved(std::size_t block, ObjectId object, Record& record, RouteBlock& out);
  void show(std::size_t block, ObjectId object, GridIndex home, const BoxType* before, const BoxType* after);
  void plan_gather(std::vector<std::uint64_t>& costs);
  void gather(std::size_t task);
  void plan_drain(std::vector<std::uint64_t>& costs);
  void drain(std::size_t task);
  void report(DrainTask& task);
  void partition(DrainTask& task) const;
  void plan_reduce(std::vector<std::uint64_t>& costs);
  void reduce(std::size_t shard);
  static void keep_changes(Shard& shard, const WitnessTable& before);
  void finish_step();
  void finish_sweep();
  void commit_sweep() noexcept;
  void pass_sweep(std::size_t steps);
  void pass_idle_step();
  void pass_idle_steps();
  void take_back_step() noexcept;
  void make_cells();
  void make_cells(const std::vector<BoxType>& scene, const typename GridFit<Scalar, Dim>::Result& result);
  void fill_cells();
  void fill_counted();

  void follow_scene();
  void follow_with_counts();
  void follow_with_levels();
  void start_single(const typename GridFit<Scalar, Dim>::Result& result, const GridSpec<Scalar, Dim>& spec);
  [[nodiscard]] GridSpec<Scalar, Dim> bounded(const typename GridFit<Scalar, Dim>::Result& result) const;
  void start_family(double cell_size, const std::array<double, Dim>& origin, const std::vector<BoxType>& sample);
  [[nodiscard]] typename GridFit<Scalar, Dim>::Result fit(const std::vector<BoxType>& sample) const;
  [[nodiscard]] std::vector<BoxType> sample(std::size_t count) const;
  [[nodiscard]] std::size_t grid_shards() const;

  [[nodiscard]] std::size_t shard_of(PairKey pair) const { return WitnessTable::hash(pair) >> shard_shift_; }
  void validate_residents() const;
  void validate_witnesses() const;
  void validate_pairs() const;
  template <class Visit>
  void for_each_pair(Visit&& visit) const;
  [[nodiscard]] std::vector<PairKey> swept_pairs() const;
  [[nodiscard]] const BoxType& stepped_box(ObjectId object) const;
  [[nodiscard]] bool meet_in(PairKey pair, GridIndex grid, std::uint64_t cell) const;

  Config config_;
  std::shared_ptr<Executor> executor_;
  Objects objects_;
  LevelsType levels_;
  Regrid regrid_;

  typename GridFit<Scalar, Dim>::Result fitted_;  // with witness counts: where the grid is
  bool gridded_ = false;
  bool sweeping_ = false;    // the step that runs, or the latest, keeps no cells
  bool celled_ = true;       // the cells are those of the latest step; else there are none
  std::uint64_t pairs_ = 0;  // by the events
  bool idle_ = true;         // the latest step had nothing to do
  bool regridding_ = false;  // with witness counts: this step inserts every object into a new grid
  StepBudget budget_;
  std::size_t event_bytes_;
  SceneSweep<Scalar, Dim> sweep_;
  MethodChoice method_;
  StepList<std::uint32_t> marked_;  // granules that the step looks at
  std::size_t changes_ = 0;         // that the step applies, estimated
  bool alone_ = false;              // the step that runs is the calling thread's alone
  StepItems<RouteBlock> blocks_;
  StepItems<GatherTask> gathers_;
  std::uint64_t task_cost_ = 1;
  StepItems<DrainTask> tasks_;
  // Idle steps since the latest one that had anything to do, as far as lists do not know of them yet.
  std::size_t idle_steps_ = 0;
  std::vector<Shard> shards_;
  int shard_shift_ = 64;

  StepCounters counters_;
  StepCounters total_;
  std::uint64_t steps_ = 0;
  std::uint64_t refused_ = 0;  // steps that were over the budget

  std::unique_ptr<StageGraph> graph_;
  StageGraph::StageId reduce_stage_ = 0;
};

}  // namespace sweepgrid
