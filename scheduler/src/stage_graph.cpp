#include <sweepgrid/scheduler/stage_graph.hpp>

#include <atomic>
#include <exception>
#include <optional>
#include <stdexcept>
#include <utility>

#include <oneapi/tbb/flow_graph.h>

#include <sweepgrid/scheduler/floating_point_mode.hpp>
#include <sweepgrid/scheduler/recording_executor.hpp>

#include "arena_executor.hpp"
#include "task_order.hpp"

namespace sweepgrid {
namespace {

using Clock = std::chrono::steady_clock;
using Node = oneapi::tbb::flow::continue_node<oneapi::tbb::flow::continue_msg>;

std::int64_t nanoseconds(Clock::duration duration) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
}

// Null when there is none.
ArenaExecutor* arena_behind(Executor& executor) {
  if (auto* const recording = dynamic_cast<RecordingExecutor*>(&executor)) return arena_behind(recording->runs_on());
  return dynamic_cast<ArenaExecutor*>(&executor);
}

/// One stage with the buffers that it keeps from run to run. Written by the one thread that runs the stage, except
/// `records`, of which each task writes its own.
struct Stage {
  std::string name;
  StageGraph::Plan plan;
  StageGraph::Body body;
  bool waits = false;
  std::function<void(std::size_t)> run_place;
  std::vector<std::uint64_t> costs;
  TaskOrder order;
  TaskTrace records;
  double seconds = 0;
  std::optional<Node> node;
};

}  // namespace

struct StageGraph::Impl {
  explicit Impl(std::shared_ptr<Executor> chosen)
      : executor(std::move(chosen)),
        arena_executor(arena_behind(*executor)),
        recorder(dynamic_cast<RecordingExecutor*>(executor.get())) {
    // A flow graph runs where it was made.
    if (arena_executor != nullptr) arena_executor->execute([this] { graph.emplace(); });
  }

  void run_stage(StageId id) noexcept;
  void run_tasks(Stage& stage);
  void run_recorded(StageId id, std::uint32_t task);
  void run_graph() noexcept;
  void fail() noexcept;
  void collect_trace();

  std::shared_ptr<Executor> executor;
  ArenaExecutor* arena_executor;      ///< null: stages run one after another, in the order in which they were added
  const RecordingExecutor* recorder;  ///< whose clock counts; null: the wall clock does
  std::optional<oneapi::tbb::flow::graph> graph;
  std::vector<std::unique_ptr<Stage>> stages;
  bool recording = false;
  bool alone = false;  ///< in this run
  TaskTrace trace;

  [[nodiscard]] std::int64_t now() const {
    return recorder != nullptr ? recorder->now() : nanoseconds(Clock::now().time_since_epoch());
  }
  [[nodiscard]] std::int64_t since(std::int64_t begin) const {
    return recorder != nullptr ? recorder->since(begin) : now() - begin;
  }

  std::int64_t start = 0;
  std::atomic<bool> failed = false;
  std::exception_ptr failure;  ///< written by the one that set `failed`, read after the run
};

// Catches here rather than let oneTBB cancel the graph: a flow graph whose nodes never throw needs no reset.
void StageGraph::Impl::run_stage(StageId id) noexcept {
  if (failed.load(std::memory_order_acquire)) return;
  const FloatingPointMode mode;
  Stage& stage = *stages[id];
  const Clock::time_point begin = Clock::now();
  try {
    stage.plan(stage.costs);
    run_tasks(stage);
  } catch (...) {
    fail();
  }
  stage.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
}

void StageGraph::Impl::run_tasks(Stage& stage) {
  if (stage.costs.empty()) return;
  if (recording) stage.records.assign(stage.costs.size(), {});
  if (arena_executor != nullptr) {
    stage.order.assign_for_stealing(stage.costs);
  } else {
    stage.order.assign_descending(stage.costs);
  }
  if (alone) {
    for (std::size_t place = 0; place < stage.order.size(); ++place) stage.run_place(place);
  } else {
    executor->for_each(stage.order.size(), stage.run_place);
  }
}

void StageGraph::Impl::run_recorded(StageId id, std::uint32_t task) {
  Stage& stage = *stages[id];
  const std::int64_t begin = now();
  stage.body(task);
  const int worker = alone ? 0 : executor->worker();
  stage.records[task] = {id, task, stage.costs[task], worker, begin - start, since(begin)};
}

/// Keeps the exception that is being handled, if it is the first of the run.
void StageGraph::Impl::fail() noexcept {
  if (!failed.exchange(true, std::memory_order_acq_rel)) failure = std::current_exception();
}

// The nodes use this object, so whatever oneTBB throws, nobody leaves before they have ended.
void StageGraph::Impl::run_graph() noexcept {
  try {
    for (const auto& stage : stages) {
      if (!stage->waits) stage->node->try_put({});
    }
  } catch (...) {
    fail();
  }
  try {
    graph->wait_for_all();
  } catch (...) {
    fail();
    graph->reset();  // a node may have counted some of those that it waits for
  }
}

void StageGraph::Impl::collect_trace() {
  for (const auto& stage : stages) trace.insert(trace.end(), stage->records.begin(), stage->records.end());
}

StageGraph::StageGraph(std::shared_ptr<Executor> executor) {
  if (executor == nullptr) throw std::invalid_argument("a stage graph needs an executor");
  impl_ = std::make_unique<Impl>(std::move(executor));
}

StageGraph::~StageGraph() = default;

StageGraph::StageId StageGraph::add(std::string name, const std::vector<StageId>& after, Plan plan, Body body) {
  Impl& impl = *impl_;
  const auto id = static_cast<StageId>(impl.stages.size());
  for (const StageId earlier : after) {
    if (earlier >= id) {
      throw std::invalid_argument("stage '" + name + "' waits for stage " + std::to_string(earlier) +
                                  ", which was not added yet");
    }
  }

  auto stage = std::make_unique<Stage>();
  stage->name = std::move(name);
  stage->plan = std::move(plan);
  stage->body = std::move(body);
  stage->waits = !after.empty();
  stage->run_place = [&impl, id, &added = *stage](std::size_t place) {
    const FloatingPointMode mode;  // here too: the executor may be a client's own
    const std::uint32_t task = added.order.task(place);
    if (impl.recording) {
      impl.run_recorded(id, task);
    } else {
      added.body(task);
    }
  };
  if (impl.graph) {
    stage->node.emplace(*impl.graph, [&impl, id](const oneapi::tbb::flow::continue_msg&) { impl.run_stage(id); });
    for (const StageId earlier : after) oneapi::tbb::flow::make_edge(*impl.stages[earlier]->node, *stage->node);
  }
  impl.stages.push_back(std::move(stage));
  return id;
}

void StageGraph::run(bool alone) {
  Impl& impl = *impl_;
  impl.alone = alone;
  for (const auto& stage : impl.stages) {
    stage->costs.clear();
    stage->records.clear();
    stage->seconds = 0;
  }
  impl.trace.clear();
  if (!impl.recording && impl.trace.capacity() > 0) {
    for (const auto& stage : impl.stages) TaskTrace().swap(stage->records);
    TaskTrace().swap(impl.trace);
  }
  impl.failed.store(false, std::memory_order_relaxed);
  impl.failure = nullptr;
  impl.start = impl.now();

  if (impl.graph && !alone) {
    impl.executor->execute([&impl] { impl.run_graph(); });
  } else {
    // Stages wait only for earlier ones, so the order of adding is a topological one.
    for (StageId id = 0; id != impl.stages.size(); ++id) impl.run_stage(id);
  }

  // Before anything else that may throw: the failure of a run must not be that of a later one.
  if (impl.failure) std::rethrow_exception(std::exchange(impl.failure, nullptr));
  if (impl.recording) impl.collect_trace();
}

void StageGraph::record(bool on) { impl_->recording = on; }
const TaskTrace& StageGraph::trace() const { return impl_->trace; }
std::size_t StageGraph::size() const { return impl_->stages.size(); }
const std::string& StageGraph::name(StageId stage) const { return impl_->stages.at(stage)->name; }
double StageGraph::seconds(StageId stage) const { return impl_->stages.at(stage)->seconds; }

std::size_t StageGraph::bytes() const {
  std::size_t total =
      sizeof(Impl) + impl_->stages.capacity() * sizeof(impl_->stages[0]) + impl_->trace.capacity() * sizeof(TaskRecord);
  for (const auto& stage : impl_->stages) {
    total += sizeof(Stage) + stage->costs.capacity() * sizeof(stage->costs[0]) + stage->order.bytes() +
             stage->records.capacity() * sizeof(TaskRecord);
  }
  return total;
}

}  // namespace sweepgrid
