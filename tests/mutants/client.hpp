#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <new>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <sweepgrid/engine/engine.hpp>
#include <sweepgrid/sap/invariant.hpp>

/// What the probes of the engine share.
namespace sweepgrid {

/// Many workers as far as the engine can see; but one thread does all, the last task first, so that every run is the
/// same.
class Backwards final : public Executor {
 public:
  [[nodiscard]] int concurrency() const override { return 4; }
  [[nodiscard]] int worker() const override { return 0; }
  void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override {
    while (count > 0) body(--count);
  }
  void execute(const std::function<void()>& work) override { work(); }
};

/// A client that believes the events, and a list of boxes that knows better.
class Client {
 public:
  using BoxType = Box<float, 2>;

  void set(std::uint64_t key, const BoxType& box) { boxes_.insert_or_assign(key, box); }
  void erase(std::uint64_t key) {
    boxes_.erase(key);
    erased_.insert(key);
  }

  /// The name of a broken invariant and what broke it; empty if all is well. "oracle": no event tells of a change.
  std::string hear(const Events<std::uint64_t>& events) {
    const auto less = [](const auto& a, const auto& b) { return key_pair(a) < key_pair(b); };
    for (const auto* list : {&events.ends, &events.begins}) {
      const auto unordered =
          std::adjacent_find(list->begin(), list->end(), [&](const auto& a, const auto& b) { return !less(a, b); });
      if (unordered != list->end()) return "E3: not sorted and unique at " + text(key_pair(*unordered));
    }
    for (const auto& pair : events.ends) {
      if (known_.erase(key_pair(pair)) == 0) return "E2: an end without a begin: " + text(key_pair(pair));
    }
    for (const auto& pair : events.begins) {
      const bool ended = std::binary_search(events.ends.begin(), events.ends.end(), pair, less);
      if (ended && !erased_.contains(pair.first) && !erased_.contains(pair.second)) {
        return "E3: ended and begun at once: " + text(key_pair(pair));
      }
      if (!known_.insert(key_pair(pair)).second) return "E2: begun twice: " + text(key_pair(pair));
    }
    erased_.clear();
    return truth() == known_ ? "" : "oracle: the events do not lead to the overlaps of the boxes";
  }

 private:
  using KeyPair = std::pair<std::uint64_t, std::uint64_t>;

  static KeyPair key_pair(const Pair<std::uint64_t>& pair) { return {pair.first, pair.second}; }
  static std::string text(const KeyPair& pair) {
    return "(" + std::to_string(pair.first) + ", " + std::to_string(pair.second) + ")";
  }

  [[nodiscard]] std::set<KeyPair> truth() const {
    std::vector<std::pair<std::uint64_t, BoxType>> boxes(boxes_.begin(), boxes_.end());
    std::sort(boxes.begin(), boxes.end(),
              [](const auto& a, const auto& b) { return a.second.min[0] < b.second.min[0]; });
    std::set<KeyPair> overlaps;
    for (auto a = boxes.begin(); a != boxes.end(); ++a) {
      for (auto b = std::next(a); b != boxes.end() && b->second.min[0] <= a->second.max[0]; ++b) {
        if (a->second.overlaps(b->second)) overlaps.insert(std::minmax(a->first, b->first));
      }
    }
    return overlaps;
  }

  std::map<std::uint64_t, BoxType> boxes_;
  std::set<KeyPair> known_;
  std::set<std::uint64_t> erased_;  // since the latest step; their keys may have been taken over
};

inline std::string text_of(const std::exception& error) {
  if (dynamic_cast<const InvariantError*>(&error) != nullptr) return error.what();
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) return "limit: out of memory";
  return std::string("oracle: exception: ") + error.what();
}

}  // namespace sweepgrid
