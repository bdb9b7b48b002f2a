#pragma once

#include <functional>
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
      "candidates", {filter_stage_}, [this](std::vector<std::uint64_t>& costs) { plan_candidates(costs); },
      [this](std::size_t shard) { prepare_candidates(shard); });
}

template <class Scalar, int Dim>
bool EnvelopeFilter<Scalar, Dim>::run_step(bool query) {
  recycle();
  query_ = query;
  ran_ = !envelopes_.granules().empty();
  for (std::size_t list = 0; list < new_lists() && !ran_; ++list) {
    ran_ = !core_.begins(list).empty() || !core_.ends(list).empty();
  }
  if (ran_) {
    if (lists_.bound() < envelopes_.bound()) lists_.grow(envelopes_.bound());
    graph_->run();
  }
  join_traces();
  return ran_;
}

// The candidates after this step, by shard; and what has changed is forgotten, by block.
template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::commit_step(std::size_t begins, std::size_t ends) {
  const std::size_t tasks = shards_used_ + blocks_;
  if (tasks <= 2) {
    for (std::size_t task = 0; task < tasks; ++task) apply(task);
  } else {
    const auto body = [this](std::size_t task) { apply(task); };
    core_.executor().for_each(tasks, std::ref(body));  // by reference, lest it be allocated
  }
  std::size_t added = 0;
  std::size_t removed = 0;
  for (const CandidateLists::Shard& shard : std::span(shards_).first(shards_used_)) {
    added += shard.entries_added(), removed += shard.entries_removed();
  }
  entries_ += added;
  entries_ -= removed;
  lists_.end_step(entries_);
  if (query_) core_.count_events(added / 2, removed / 2);
  begins_ = begins;
  ends_ = ends;
  total_begins_ += begins;
  total_ends_ += ends;
}

template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::recycle() {
  for (Task& task : tasks_) {
    task.begins_water.recycle(task.begins);
    task.ends_water.recycle(task.ends);
  }
  for (CandidateLists::Shard& shard : shards_) shard.recycle();
  blocks_ = tasks_used_ = shards_used_ = 0;
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
  if (tasks_.size() < costs.size()) tasks_.resize(costs.size());
  tasks_used_ = costs.size();
}

// Reads the lists of candidates as they were at the previous step: what is new comes from the core's events, of what
// is none any more the boxes part by themselves.
template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::filter(std::size_t index) {
  Task& task = tasks_[index];
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

template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::plan_candidates(std::vector<std::uint64_t>& costs) {
  std::size_t changes = 0;
  for (std::size_t list = 0; list < new_lists(); ++list) changes += core_.begins(list).size() + core_.ends(list).size();
  const auto workers = static_cast<std::size_t>(core_.executor().concurrency());
  const std::size_t shards = changes == 0 ? 0 : changes < 1024 ? 1 : workers;
  if (shards_.size() < shards) shards_.resize(shards);
  shards_used_ = shards;
  costs.assign(shards, 1);
}

template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::prepare_candidates(std::size_t index) {
  CandidateLists::Shard& shard = shards_[index];
  shard.reset(index, shards_used_);
  for (std::size_t list = 0; list < new_lists(); ++list) {
    shard.add(core_.begins(list));
    shard.remove(core_.ends(list));
  }
  lists_.prepare(shard);
}

template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::apply(std::size_t task) noexcept {
  if (task < shards_used_) return lists_.apply(shards_[task]);
  for (const std::uint32_t granule : granules(task - shards_used_)) envelopes_.settle(granule);
}

template <class Scalar, int Dim>
std::size_t EnvelopeFilter<Scalar, Dim>::bytes() const {
  std::size_t bytes = sizeof(*this) + lists_.bytes() + graph_->bytes() + trace_.capacity() * sizeof(TaskRecord) +
                      tasks_.capacity() * sizeof(Task) + shards_.capacity() * sizeof(CandidateLists::Shard);
  for (const Task& task : tasks_) bytes += (task.begins.capacity() + task.ends.capacity()) * sizeof(PairKey);
  for (const CandidateLists::Shard& shard : shards_) bytes += shard.bytes();
  return bytes;
}

template <class Scalar, int Dim>
void EnvelopeFilter<Scalar, Dim>::add_stats(Stats& stats) const {
  stats.step.begins = begins_;
  stats.step.ends = ends_;
  stats.total.begins = total_begins_;
  stats.total.ends = total_ends_;
  stats.pairs = total_begins_ - total_ends_;
  stats.bytes_witnesses += bytes();
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
