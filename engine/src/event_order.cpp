#include <sweepgrid/engine/event_order.hpp>

#include <algorithm>
#include <utility>

namespace sweepgrid {

EventOrder::EventOrder(const KeyTable& keys, Source source)
    : keys_(keys), source_(std::move(source)), ranks_{KeyRanks(keys), KeyRanks(keys)} {}

template <class Stage>
void EventOrder::for_each_stage(Stage&& stage) {
  if (!by_value()) {
    stage("rank", &EventOrder::plan_rank, &EventOrder::rank);
    stage("merge ranks", &EventOrder::plan_merge_ranks, &EventOrder::merge_ranks);
  }
  stage("order", &EventOrder::plan_order, &EventOrder::order);
  stage("merge", &EventOrder::plan_merge, &EventOrder::merge);
}

void EventOrder::add_stages(StageGraph& graph, StageGraph::StageId after, const Executor& executor) {
  workers_ = static_cast<std::size_t>(executor.concurrency());
  for_each_stage([&](const char* name, auto plan, auto body) {
    after = graph.add(
        name, {after}, [this, plan](std::vector<std::uint64_t>& costs) { costs.assign((this->*plan)(), 1); },
        [this, body](std::size_t task) { (this->*body)(task); });
  });
}

void EventOrder::run(const Lists& lists) {
  write_to(lists);
  for_each_stage([this](const char* /*name*/, auto plan, auto body) {
    const std::size_t tasks = (this->*plan)();
    for (std::size_t task = 0; task < tasks; ++task) (this->*body)(task);
  });
}

void EventOrder::write_to(const Lists& lists) {
  for (std::size_t list = 0; list < kLists; ++list) targets_[list].list = lists[list];
}

void EventOrder::rest() {
  for (std::size_t list = 0; list < kLists; ++list) {
    ranks_[list].reset(0);
    sorts_[list].reset(0);
    for (DigitSort& digits : digits_[list]) digits.rest();
    resize(targets_[list], 0);
  }
}

std::size_t EventOrder::shards() const { return std::min(source_.lists(), workers_); }

template <class Visit>
void EventOrder::for_shard(std::size_t list, std::size_t shard, Visit&& visit) const {
  const std::size_t lists = source_.lists();
  for (std::size_t i = shard * lists / shards(); i < (shard + 1) * lists / shards(); ++i) {
    for (const PairKey pair : source_.pairs(static_cast<List>(list), i)) visit(pair);
  }
}

// ---- ranks of keys

std::size_t EventOrder::plan_rank() {
  for (KeyRanks& ranks : ranks_) ranks.reset(shards());
  return kLists * shards();
}

void EventOrder::rank(std::size_t task) {
  const std::size_t list = task % kLists;
  const std::size_t shard = task / kLists;
  std::vector<ObjectId>& objects = ranks_[list].shard(shard);
  for_shard(list, shard, [&](PairKey pair) {
    objects.push_back(pair.lower());
    objects.push_back(pair.upper());
  });
  ranks_[list].sort_shard(shard);
}

std::size_t EventOrder::plan_merge_ranks() {
  for (std::size_t list = 0; list < kLists; ++list) ranges_[list] = ranks_[list].cut(2 * workers_, source_.bound());
  return ranges_[kEnds] + ranges_[kBegins];
}

void EventOrder::merge_ranks(std::size_t task) {
  const auto [list, range] = range_of(task);
  ranks_[list].merge(range);
}

// ---- pairs of ranks

std::size_t EventOrder::plan_order() {
  for (std::size_t list = 0; list < kLists; ++list) {
    if (!by_value()) ranks_[list].require_total();
    sorts_[list].reset(shards());
    const std::size_t sorters = std::max(shards(), 2 * workers_);
    if (digits_[list].size() < sorters) digits_[list].resize(sorters);
    for (DigitSort& digits : digits_[list]) digits.rest();
  }
  return kLists * shards();
}

void EventOrder::order(std::size_t task) {
  const std::size_t list = task % kLists;
  const std::size_t shard = task / kLists;
  std::vector<RankPair>& pairs = sorts_[list].shard(shard);
  ranks_[list].with([&](auto&& rank_of) {
    for_shard(list, shard, [&](PairKey pair) {
      const std::uint64_t a = rank_of(pair.lower());
      const std::uint64_t b = rank_of(pair.upper());
      pairs.push_back({std::min(a, b), std::max(a, b)});
    });
  });
  ByRank sorter{digits_[list][shard]};
  sorts_[list].sort_shard(shard, sorter);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

std::size_t EventOrder::plan_merge() {
  // What cannot be made before it is written is written in its order.
  const std::size_t most = keys_.type().sizable ? 2 * workers_ : 1;
  for (std::size_t list = 0; list < kLists; ++list) {
    ByRank sorter{digits_[list][0]};
    ranges_[list] = sorts_[list].cut(most, sorter);
    resize(targets_[list], sorts_[list].size());
  }
  return ranges_[kEnds] + ranges_[kBegins];
}

void EventOrder::merge(std::size_t task) {
  const auto [list, range] = range_of(task);
  ByRank sorter{digits_[list][range]};
  write(list, sorts_[list].merge(range, sorter));
}

// ---- the client's lists

void EventOrder::resize(Target& target, std::size_t size) const {
  const KeyType& type = keys_.type();
  target.high_water.note(size);
  if (target.list == nullptr) return;
  const std::size_t capacity = type.capacity(target.list);
  const bool larger = capacity > target.high_water.allowed();
  if (size > capacity || larger) type.resize(target.list, 0);  // what it holds need not move along
  if (larger) type.shrink(target.list);
  type.resize(target.list, size);
}

void EventOrder::write(std::size_t list, const Sort::Range& range) const {
  const KeyType& type = keys_.type();
  const KeyRanks& ranks = ranks_[list];
  void* const target = targets_[list].list;
  if (by_value()) {
    return ranks.write(static_cast<std::byte*>(type.data(target)) + range.place * type.pair_size, range.items);
  }
  std::size_t place = range.place;
  for (const RankPair& pair : range.items) {
    type.write(target, place++, ranks.key(pair.first), ranks.key(pair.second));
  }
}

std::size_t EventOrder::bytes() const {
  std::size_t total = 0;
  for (std::size_t list = 0; list < kLists; ++list) {
    total += ranks_[list].bytes() + sorts_[list].bytes() + digits_[list].capacity() * sizeof(DigitSort);
    for (const DigitSort& digits : digits_[list]) total += digits.bytes();
    if (targets_[list].list != nullptr) total += keys_.type().capacity(targets_[list].list) * keys_.type().pair_size;
  }
  return total;
}

}  // namespace sweepgrid
