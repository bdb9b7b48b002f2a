#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <sweepgrid/engine/digit_sort.hpp>
#include <sweepgrid/engine/key_ranks.hpp>
#include <sweepgrid/engine/sharded_sort.hpp>
#include <sweepgrid/sap/high_water.hpp>
#include <sweepgrid/sap/ids.hpp>
#include <sweepgrid/scheduler/stage_graph.hpp>

namespace sweepgrid {

/// The last stages of a step: what the step found is sorted by the client's keys, freed of duplicates, and written to
/// the client's lists. The result does not depend on the number of threads.
class EventOrder {
 public:
  enum List : std::size_t { kEnds, kBegins, kLists };

  /// What is sorted: lists of pairs in no order, in which a pair may stand several times, but only in one of them.
  struct Source {
    std::function<std::size_t()> lists;
    std::function<std::span<const PairKey>(List, std::size_t index)> pairs;
    std::function<ObjectId()> bound;  ///< objects are below it
  };

  /// The client's lists of events: std::vector<Pair<Key>>.
  using Lists = std::array<void*, kLists>;

  /// `keys` must outlive it.
  EventOrder(const KeyTable& keys, Source source);

  /// Adds the stages after `after`. A run of the graph writes to what write_to() named.
  void add_stages(StageGraph& graph, StageGraph::StageId after, const Executor& executor);
  void write_to(const Lists& lists);

  /// All at once, on the calling thread.
  void run(const Lists& lists);

  /// Empties the client's lists. To be called in every step that does not run the stages, so that memory goes back.
  void rest();

  void trim(ObjectId bound) {
    for (KeyRanks& ranks : ranks_) ranks.trim(bound);
  }
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct ByRank {
    DigitSort& digits;
    [[nodiscard]] static bool less(const RankPair& a, const RankPair& b) {
      return a.first < b.first || (a.first == b.first && a.second < b.second);
    }
    void sort(std::span<RankPair> pairs) const { digits.sort(pairs); }
  };
  using Sort = ShardedSort<RankPair, ByRank>;

  /// One of the client's lists.
  struct Target {
    void* list = nullptr;
    HighWater high_water;
  };

  // Stages: `rank` and `merge ranks` where keys are not their own ranks, `order`, `merge`. Each: how many tasks, and
  // one.
  std::size_t plan_rank();
  void rank(std::size_t task);
  std::size_t plan_merge_ranks();
  void merge_ranks(std::size_t task);
  std::size_t plan_order();
  void order(std::size_t task);
  std::size_t plan_merge();
  void merge(std::size_t task);

  template <class Stage>
  void for_each_stage(Stage&& stage);
  [[nodiscard]] std::size_t shards() const;
  [[nodiscard]] bool by_value() const { return ranks_[kEnds].values(); }
  struct ListRange {
    std::size_t list;
    std::size_t range;
  };
  [[nodiscard]] ListRange range_of(std::size_t task) const {
    return task < ranges_[kEnds] ? ListRange{kEnds, task} : ListRange{kBegins, task - ranges_[kEnds]};
  }
  template <class Visit>
  void for_shard(std::size_t list, std::size_t shard, Visit&& visit) const;
  void resize(Target& target, std::size_t size) const;
  void write(std::size_t list, const Sort::Range& range) const;

  const KeyTable& keys_;
  Source source_;
  std::size_t workers_ = 1;
  std::array<Target, kLists> targets_;
  std::array<KeyRanks, kLists> ranks_;
  std::array<Sort, kLists> sorts_;
  std::array<std::vector<DigitSort>, kLists> digits_;  // for each shard or range
  std::array<std::size_t, kLists> ranges_{};           // the tasks of a merge: those of one list, then of the other
};

}  // namespace sweepgrid
