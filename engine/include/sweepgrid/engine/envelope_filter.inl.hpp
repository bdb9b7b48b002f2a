#pragma once

#include <string>

#include <sweepgrid/engine/envelope_filter.hpp>
#include <sweepgrid/sap/invariant.hpp>

namespace sweepgrid {

template <class Scalar, int Dim>
EnvelopeFilter<Scalar, Dim>::EnvelopeFilter(Core& core, BoxesAndEnvelopes& envelopes)
    : core_(core), envelopes_(envelopes) {
  // Not owned: the core's executor outlives this.
  graph_ = std::make_unique<StageGraph>(std::shared_ptr<Executor>(std::shared_ptr<Executor>(), &core.executor()));
  filter_stage_ = graph_->add(
      "filter", {}, [this](std::vector<std::uint64_t>& costs) { plan_filter(costs); },
      [this](std::size_t task) { filter(task); });
  graph_->add(
      "candidates", {filter_stage_}, [this](std::vector<std::uint64_t>& costs) { plan_settle(costs); },
      [this](std::size_t task) { settle(task); });
}

template <class Scalar, int Dim>
bool EnvelopeFilter<Scalar, Dim>::step(bool query) {
  query_ = query;
  bool& any = ran_;
  any = !envelopes_.granules().empty();
  for (std::size_t list = 0; list < new_lists() && !any; ++list) {
    any = !core_.begins(list).empty() || !core_.ends(list).empty();
  }
  if (any) {
    if (lists_.bound() < envelopes_.bound()) lists_.resize(envelopes_.bound());
    graph_->run();
    count_candidates();
  } else if (query) {
    core_.count_events(0, 0);
  }
  join_traces();
  return any;
}

// One after the other, as they ran.
template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::join_traces() {
  trace_.clear();
  if (query_) trace_ = core_.graph().trace();
  std::int64_t end = 0;
  for (const TaskRecord& task : trace_) end = std::max(end, task.start_ns + task.duration_ns);
  if (!ran_) return;
  for (TaskRecord task : graph_->trace()) {
    task.stage += static_cast<std::uint32_t>(core_.graph().size());
    task.start_ns += end;
    trace_.push_back(task);
  }
}

template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::plan_filter(std::vector<std::uint64_t>& costs) {
  constexpr std::size_t kSmallest = 4;  // granules that are worth a task
  const auto workers = static_cast<std::size_t>(core_.executor().concurrency());
  const std::size_t changed = envelopes_.granules().size();
  blocks_ = workers == 1 ? std::min<std::size_t>(changed, 1) : std::min(changed / kSmallest + 1, 8 * workers);
  for (std::size_t block = 0; block < blocks_; ++block) costs.push_back(256 * granules(block).size());
  for (std::size_t list = 0; list < new_lists(); ++list) costs.push_back(core_.begins(list).size());
  tasks_.resize(costs.size());
}

// Reads the lists of candidates as they were at the previous step: what is new comes from the core's events, of what
// is none any more the boxes part by themselves.
template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::filter(std::size_t index) {
  Task& task = tasks_[index];
  task.begins.clear();
  task.ends.clear();
  if (index >= blocks_) {
    for (const PairKey pair : core_.begins(index - blocks_)) {
      if (do_overlap(pair.lower(), pair.upper())) task.begins.push_back(pair);
    }
    return;
  }
  for (const std::uint32_t granule : granules(index)) {
    const ObjectId first = granule * BoxesAndEnvelopes::kGranule;
    for (ObjectId object = first; object < first + BoxesAndEnvelopes::kGranule; ++object) {
      if (envelopes_.changed(object)) filter_object(object, task);
    }
  }
}

template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::filter_object(ObjectId object, Task& out) const {
  using Ordered = OrderedBox<Scalar, Dim>;
  const bool existed = envelopes_.existed(object);
  const bool exists = envelopes_.exists(object);
  const Ordered before(envelopes_.before(object));
  const Ordered after(envelopes_.box(object));
  for (const ObjectId other : lists_.of(object)) {
    const bool changed = envelopes_.changed(other);
    if (changed && other < object) continue;  // tested there
    const Ordered now(envelopes_.box(other));
    const bool is = exists && envelopes_.exists(other) && after.overlaps(now);
    const bool was =
        existed && envelopes_.existed(other) && before.overlaps(changed ? Ordered(envelopes_.before(other)) : now);
    if (was != is) (is ? out.begins : out.ends).emplace_back(object, other);
  }
}

// The candidates after this step, by shard; and what has changed is forgotten, by block.
template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::plan_settle(std::vector<std::uint64_t>& costs) {
  std::size_t changes = 0;
  for (std::size_t list = 0; list < new_lists(); ++list) changes += core_.begins(list).size() + core_.ends(list).size();
  const auto workers = static_cast<std::size_t>(core_.executor().concurrency());
  shards_.resize(changes == 0 ? 0 : changes < 1024 ? 1 : workers);
  costs.assign(shards_.size() + blocks_, 1);
}

template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::settle(std::size_t task) {
  if (task >= shards_.size()) {
    for (const std::uint32_t granule : granules(task - shards_.size())) envelopes_.settle(granule);
    return;
  }
  CandidateLists::Shard& shard = shards_[task];
  shard.reset(task, shards_.size());
  for (std::size_t list = 0; list < core_.lists(); ++list) {
    shard.add(core_.begins(list));
    shard.remove(core_.ends(list));
  }
  lists_.apply(shard);
}

template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::count_candidates() {
  std::uint64_t added = 0;
  std::int64_t growth = 0;
  for (const CandidateLists::Shard& shard : shards_) added += shard.entries_added(), growth += shard.growth();
  const auto begun = static_cast<std::size_t>(added / 2);
  const auto ended = static_cast<std::size_t>(static_cast<std::int64_t>(begun) - growth / 2);
  if (query_) core_.count_events(begun, ended);
}

template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::count_events(std::size_t begins, std::size_t ends) {
  begins_ = begins;
  ends_ = ends;
  total_begins_ += begins;
  total_ends_ += ends;
}

template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::add_stats(Stats& stats) const {
  stats.step.begins = begins_;
  stats.step.ends = ends_;
  stats.total.begins = total_begins_;
  stats.total.ends = total_ends_;
  stats.pairs = total_begins_ - total_ends_;
  stats.bytes_witnesses += lists_.bytes();
  for (StageGraph::StageId stage = 0; stage < graph_->size(); ++stage) {
    stats.stages.push_back({graph_->name(stage), ran_ ? graph_->seconds(stage) : 0});
  }
}

template <class Scalar, int Dim>
std::vector<PairKey> EnvelopeFilter<Scalar, Dim>::pairs() const {
  std::vector<PairKey> pairs;
  for (std::size_t object = 0; object < lists_.bound(); ++object) {
    const auto own = static_cast<ObjectId>(object);
    for (const ObjectId other : lists_.of(own)) {
      if (own < other && did_overlap(own, other)) pairs.emplace_back(own, other);
    }
  }
  return pairs;
}

template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::validate() const {
  std::vector<PairKey> candidates;
  for (std::size_t object = 0; object < lists_.bound(); ++object) {
    const auto own = static_cast<ObjectId>(object);
    for (const ObjectId other : lists_.of(own)) candidates.emplace_back(own, other);
  }
  std::vector<PairKey> pairs = core_.pairs();
  pairs.insert(pairs.end(), pairs.begin(), pairs.end());  // each is in two lists
  std::sort(candidates.begin(), candidates.end());
  std::sort(pairs.begin(), pairs.end());
  require_invariant(candidates == pairs, "V2", [&] {
    return std::to_string(candidates.size()) + " entries in lists of candidates for " + std::to_string(pairs.size()) +
           " entries of pairs of envelopes, or others";
  });
}

}  // namespace sweepgrid
