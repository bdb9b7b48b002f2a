#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <sweepgrid/engine/events.hpp>
#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/sap/cell_op.hpp>

#include "every_overlap.hpp"

/// The brute-force oracle of engines. Needs no test framework, so that small programs can use it too.
namespace sweepgrid::oracle {

/// One queueing call.
template <class Scalar, int Dim>
struct EngineOp {
  OpKind kind = OpKind::kInsert;
  std::uint64_t key = 0;
  Box<Scalar, Dim> box{};
};

template <class Scalar, int Dim>
using EngineOps = std::vector<EngineOp<Scalar, Dim>>;

/// What an engine should say: compares every box with every other.
template <class Scalar, int Dim, class Key = std::uint64_t, class Order = std::less<Key>>
class EngineModel {
 public:
  using BoxType = Box<Scalar, Dim>;

  void insert(const Key& key, const BoxType& box) {
    boxes_.insert_or_assign(key, box);
    fresh_.insert(key);
  }
  void update(const Key& key, const BoxType& box) { boxes_.at(key) = box; }
  void erase(const Key& key) { boxes_.erase(key); }
  void apply(const EngineOps<Scalar, Dim>& ops) {
    for (const auto& op : ops) {
      if (op.kind == OpKind::kInsert) insert(op.key, op.box);
      if (op.kind == OpKind::kUpdate) update(op.key, op.box);
      if (op.kind == OpKind::kErase) erase(op.key);
    }
  }

  /// The events of everything since the last call.
  const Events<Key>& step() {
    std::vector<Key> keys;  // sorted, for the map is; and so the pairs come out sorted
    std::vector<BoxType> boxes;
    for (const auto& [key, box] : boxes_) keys.push_back(key), boxes.push_back(box);
    std::vector<Pair<Key>> now;
    every_overlap(boxes, [&](std::size_t a, std::size_t b) { now.push_back({keys[a], keys[b]}); });
    // A key that was inserted anew names another object than before: its old pairs end and its new ones begin.
    const auto fresh = [this](const Pair<Key>& pair) {
      return !fresh_.empty() && fresh_.count(pair.first) + fresh_.count(pair.second) > 0;
    };
    const auto missing = [&](const std::vector<Pair<Key>>& list, const std::vector<Pair<Key>>& other) {
      std::vector<Pair<Key>> result;
      auto at = other.begin();
      for (const auto& pair : list) {
        while (at != other.end() && less(*at, pair)) ++at;
        if (at == other.end() || less(pair, *at) || fresh(pair)) result.push_back(pair);
      }
      return result;
    };
    events_.ends = missing(pairs_, now);
    events_.begins = missing(now, pairs_);
    pairs_ = std::move(now);
    fresh_.clear();
    return events_;
  }

  /// Those of the last step.
  [[nodiscard]] const Events<Key>& events() const { return events_; }
  [[nodiscard]] const std::vector<Pair<Key>>& pairs() const { return pairs_; }
  [[nodiscard]] const std::map<Key, BoxType, Order>& boxes() const { return boxes_; }

  static bool less(const Pair<Key>& a, const Pair<Key>& b) {
    const Order order;
    return order(a.first, b.first) || (!order(b.first, a.first) && order(a.second, b.second));
  }

 private:
  std::map<Key, BoxType, Order> boxes_;
  std::set<Key, Order> fresh_;  // inserted since the last step
  std::vector<Pair<Key>> pairs_;
  Events<Key> events_;
};

/// The first difference of two lists of pairs in words; nothing when they are the same, order and duplicates included.
template <class Key>
std::string difference(const char* what, const std::vector<Pair<Key>>& expected, const std::vector<Pair<Key>>& actual) {
  if (expected == actual) return {};
  std::ostringstream text;
  text << actual.size() << " " << what << " instead of " << expected.size();
  const auto [want, got] = std::mismatch(expected.begin(), expected.end(), actual.begin(), actual.end());
  const auto say = [&](const char* label, const auto& list, auto at) {
    text << "; " << label << " at " << at - list.begin() << ": ";
    if (at == list.end()) {
      text << "nothing";
    } else if constexpr (requires { text << at->first; }) {
      text << "(" << at->first << ", " << at->second << ")";
    }
  };
  say("expected", expected, want);
  say("found", actual, got);
  return text.str();
}

template <class Key>
std::string difference(const Events<Key>& expected, const Events<Key>& actual) {
  std::string wrong = difference("ends", expected.ends, actual.ends);
  return wrong.empty() ? difference("begins", expected.begins, actual.begins) : wrong;
}

/// Compares all that can be asked of the engine after a step with the model, and validates it.
template <class EngineType, class Model>
std::string compare(const EngineType& engine, const Model& model) {
  std::string wrong = difference("pairs", model.pairs(), engine.pairs());
  if (!wrong.empty()) return wrong;
  if (engine.size() != model.boxes().size()) return "size() is " + std::to_string(engine.size());
  for (const auto& [key, box] : model.boxes()) {
    const auto handle = engine.find(key);
    if (!handle) return "a key is unknown";
    if (!engine.contains(key) || !(engine.key(*handle) == key) || engine.box(*handle) != box) {
      return "contains(), key() or box() of an object is wrong";
    }
  }
  try {
    engine.validate();
  } catch (const std::exception& error) {
    return std::string("validate(): ") + error.what();
  }
  return {};
}

}  // namespace sweepgrid::oracle
