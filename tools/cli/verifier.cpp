#include "cli/verifier.hpp"

#include <algorithm>
#include <iterator>
#include <unordered_set>

#include <fmt/format.h>

namespace sweepgrid {
namespace {

const ScenePairOrder kBefore;

std::string box_text(const OverlapOracle& oracle, SceneKey key) {
  if (!oracle.contains(key)) return fmt::format("{} is not there", key);
  const SceneBox& box = oracle.box(key);
  return fmt::format("{} [{}] to [{}]", key, fmt::join(box.min, ", "), fmt::join(box.max, ", "));
}

std::vector<ScenePair> without(const std::vector<ScenePair>& all, const std::vector<ScenePair>& some) {
  std::vector<ScenePair> rest;
  std::set_difference(all.begin(), all.end(), some.begin(), some.end(), std::back_inserter(rest), kBefore);
  return rest;
}

std::vector<ScenePair> sorted(std::vector<ScenePair> pairs) {
  std::sort(pairs.begin(), pairs.end(), kBefore);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace

bool Verifier::check_step(const SceneStep& ops, const Events<SceneKey>& events, Guarantee promised) {
  if (started_) ++step_;
  result_.promised = std::max(result_.promised, promised);
  started_ = true;
  oracle_.apply(ops);
  expected_ = oracle_.pairs();
  check_list("ends", events.ends);
  check_list("begins", events.begins);
  apply_events(ops, events);
  compare_with_oracle(promised);
  if (!result_.ok()) return false;
  result_.steps = step_;
  result_.pairs += expected_.size();
  return true;
}

bool Verifier::check_pairs(const std::vector<ScenePair>& pairs) {
  check_list("pairs()", pairs);
  const std::vector<ScenePair> found = sorted(pairs);
  for (const ScenePair& pair : without(current_, found)) {
    note(result_.missing, pair, "there according to the events, but not according to pairs()");
  }
  for (const ScenePair& pair : without(found, current_)) {
    note(result_.extra, pair, "not there according to the events, but according to pairs()");
  }
  return result_.ok();
}

void Verifier::check_list(std::string_view name, const std::vector<ScenePair>& list) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].first >= list[i].second) {
      note(result_.misordered, list[i], fmt::format("in {}: its first key is not the lower one", name));
    }
    if (i == 0 || kBefore(list[i - 1], list[i])) continue;
    if (list[i - 1] == list[i]) {
      note(result_.duplicate, list[i], fmt::format("twice in {}", name));
    } else {
      note(result_.misordered, list[i],
           fmt::format("in {} behind ({}, {})", name, list[i - 1].first, list[i - 1].second));
    }
  }
}

void Verifier::apply_events(const SceneStep& ops, const Events<SceneKey>& events) {
  const std::vector<ScenePair> ends = sorted(events.ends);
  const std::vector<ScenePair> begins = sorted(events.begins);
  for (const ScenePair& pair : without(ends, current_)) {
    note(result_.spurious, pair, "an end, but the pair was not there");
  }
  // Only an object that was erased and inserted again ends and begins the same pair in one step.
  const std::unordered_set<SceneKey> erased(ops.erased.begin(), ops.erased.end());
  for (const ScenePair& pair : begins) {
    if (!std::binary_search(ends.begin(), ends.end(), pair, kBefore)) continue;
    if (erased.contains(pair.first) || erased.contains(pair.second)) continue;
    note(result_.spurious, pair, "an end and a begin in one step");
  }
  const std::vector<ScenePair> left = without(current_, ends);
  std::vector<ScenePair> next;
  std::set_union(left.begin(), left.end(), begins.begin(), begins.end(), std::back_inserter(next), kBefore);
  if (next.size() != left.size() + begins.size()) {
    for (const ScenePair& pair : begins) {
      if (!std::binary_search(left.begin(), left.end(), pair, kBefore)) continue;
      note(result_.spurious, pair, "a begin, but the pair was there");
    }
  }
  current_ = std::move(next);
}

void Verifier::compare_with_oracle(Guarantee promised) {
  if (current_ == expected_) return;
  for (const ScenePair& pair : without(expected_, current_)) {
    if (promised == Guarantee::kMayMiss) {
      ++result_.missing;
    } else {
      note(result_.missing, pair, "overlaps, but not according to the events");
    }
  }
  for (const ScenePair& pair : without(current_, expected_)) {
    if (promised != Guarantee::kExact) {
      ++result_.extra;
    } else {
      note(result_.extra, pair, "does not overlap, but does according to the events");
    }
  }
}

void Verifier::note(std::uint64_t& counter, const ScenePair& pair, std::string_view what) {
  ++counter;
  if (!result_.ok()) return;
  result_.first_error = fmt::format("step {}: pair ({}, {}): {}; boxes: {}; {}", step_, pair.first, pair.second, what,
                                    box_text(oracle_, pair.first), box_text(oracle_, pair.second));
}

}  // namespace sweepgrid
