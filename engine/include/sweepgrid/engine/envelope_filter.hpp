#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <sweepgrid/engine/candidate_lists.hpp>
#include <sweepgrid/engine/engine_core.hpp>
#include <sweepgrid/engine/envelopes.hpp>
#include <sweepgrid/sap/high_water.hpp>
#include <sweepgrid/sap/ids.hpp>
#include <sweepgrid/scheduler/stage_graph.hpp>

namespace sweepgrid {

/// With EnvelopeOptions::exact: the pairs of envelopes are kept as candidates, and the events of the boxes are found
/// among them. A pair of boxes that overlapped at the previous step was a candidate then; so what has to be tested
/// are the candidates of objects whose boxes changed, and the new ones. Nothing is kept of a pair but that it is a
/// candidate: whether it has begun or ended follows from the boxes at both steps.
///
/// A graph of stages of its own, run after that of the engine; the engine adds the order of events.
template <class Scalar, int Dim>
class EnvelopeFilter {
 public:
  using Core = EngineCore<Scalar, Dim>;
  using BoxesAndEnvelopes = Envelopes<Scalar, Dim>;

  EnvelopeFilter(Core& core, BoxesAndEnvelopes& envelopes);

  [[nodiscard]] StageGraph& graph() { return *graph_; }
  [[nodiscard]] const StageGraph& graph() const { return *graph_; }
  /// What stages that read the lists of events wait for.
  [[nodiscard]] StageGraph::StageId last_stage() const { return filter_stage_; }

  /// Finds the events of this step; `query`: the core has run one. Returns false, and does not run the graph, where
  /// there can be none. What clients can ask for stays that of the latest step, also if it throws, until commit_step().
  bool run_step(bool query);
  /// The step that run_step() ran is the latest one. `begins`, `ends`: how many events it has, free of doubles. Throws
  /// nothing, but what the executor's own allocations throw.
  void commit_step(std::size_t begins, std::size_t ends);

  /// As EngineCore's.
  [[nodiscard]] std::size_t lists() const { return tasks_used_; }
  [[nodiscard]] std::span<const PairKey> begins(std::size_t list) const { return tasks_[list].begins; }
  [[nodiscard]] std::span<const PairKey> ends(std::size_t list) const { return tasks_[list].ends; }
  [[nodiscard]] std::vector<PairKey> pairs() const;

  /// Whether trace() is kept: the tasks of the core's graph and of this one, whose stages come after, in the latest
  /// step.
  void record(bool on) { graph_->record(on); }
  [[nodiscard]] const TaskTrace& trace() const { return trace_; }
  /// Puts what clients see in place of what the core saw: events, pairs, the stages of this graph too.
  void add_stats(Stats& stats) const;

  void trim(std::size_t bound) { lists_.trim(bound); }

  /// V2: the candidates are the pairs of the core. Throws InvariantError. Precondition: nothing queued there.
  void validate() const;

 private:
  /// A part of the granules with changed objects, or a list of new candidates; and what began and ended there.
  struct Task {
    std::vector<PairKey> begins;
    std::vector<PairKey> ends;
    HighWater begins_water;
    HighWater ends_water;
  };

  void plan_filter(std::vector<std::uint64_t>& costs);
  void filter(std::size_t task);
  void filter_object(ObjectId object, Task& out) const;
  void plan_candidates(std::vector<std::uint64_t>& costs);
  void prepare_candidates(std::size_t shard);
  void apply(std::size_t task) noexcept;
  void recycle();
  void join_traces();
  [[nodiscard]] std::size_t bytes() const;

  [[nodiscard]] std::size_t new_lists() const { return query_ ? core_.lists() : 0; }
  [[nodiscard]] std::span<const std::uint32_t> granules(std::size_t block) const {
    const auto all = envelopes_.granules();
    const std::size_t first = block * all.size() / blocks_;
    return all.subspan(first, (block + 1) * all.size() / blocks_ - first);
  }
  [[nodiscard]] bool did_overlap(ObjectId a, ObjectId b) const {
    return envelopes_.existed(a) && envelopes_.existed(b) && meet(envelopes_.before(a), envelopes_.before(b));
  }
  [[nodiscard]] bool do_overlap(ObjectId a, ObjectId b) const {
    return envelopes_.exists(a) && envelopes_.exists(b) && meet(envelopes_.box(a), envelopes_.box(b));
  }
  // As cells compare: by ordered bits, which tell denormals apart where the host flushes them to zero.
  [[nodiscard]] static bool meet(const Box<Scalar, Dim>& a, const Box<Scalar, Dim>& b) {
    return OrderedBox<Scalar, Dim>(a).overlaps(OrderedBox<Scalar, Dim>(b));
  }

  Core& core_;
  BoxesAndEnvelopes& envelopes_;
  CandidateLists lists_;
  std::size_t entries_ = 0;   // in the lists
  std::uint64_t begins_ = 0;  // of the latest step
  std::uint64_t ends_ = 0;
  std::uint64_t total_begins_ = 0;
  std::uint64_t total_ends_ = 0;
  bool ran_ = false;
  TaskTrace trace_;
  bool query_ = false;
  std::size_t blocks_ = 0;  // of granules; the first tasks
  // Never fewer than before, lest the memory of their lists is lost.
  std::vector<Task> tasks_;
  std::size_t tasks_used_ = 0;
  std::vector<CandidateLists::Shard> shards_;
  std::size_t shards_used_ = 0;
  std::unique_ptr<StageGraph> graph_;
  StageGraph::StageId filter_stage_ = 0;
};

}  // namespace sweepgrid
