#pragma once

#include <algorithm>
#include <cstdint>
#include <exception>
#include <iterator>
#include <map>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <sweepgrid/sap/sweep_and_prune.hpp>

#include "every_overlap.hpp"

/// The brute-force oracle of cells. Needs no test framework, so that small programs can use it too.
namespace sweepgrid::oracle {

/// An op with its box in world units: the oracle compares those, and so tests the conversion to ordered bits as well.
template <class Scalar, int Dim>
struct BoxOp {
  ObjectId object = kNoObject;
  OpKind kind = OpKind::kInsert;
  Box<Scalar, Dim> box{};
};

/// A visit with its boxes in world units.
template <class Scalar, int Dim>
struct BoxVisit {
  ObjectId object = kNoObject;
  bool was = false;
  bool is = false;
  Box<Scalar, Dim> before{};
  Box<Scalar, Dim> after{};
};

template <class Scalar, int Dim>
using Drain = std::vector<BoxOp<Scalar, Dim>>;

/// What a cell was told, drain by drain.
template <class Scalar, int Dim>
using History = std::vector<Drain<Scalar, Dim>>;

/// Knows what a cell should hold and which pairs overlap, by comparing every box with every other.
template <class Scalar, int Dim>
class CellOracle {
 public:
  using Cell = SweepAndPrune<Scalar, Dim>;
  using Op = BoxOp<Scalar, Dim>;

  /// Drains `ops` into `cell` and says what is wrong with the outcome; nothing if all is well. Compared: the sum of
  /// each pair's deltas with the change of its state, both ways; residents and boxes; delta counter; validate().
  std::string drain(Cell& cell, std::span<const Op> ops) {
    std::vector<CellOp<Scalar, Dim>> cell_ops;
    for (const Op& op : ops) cell_ops.push_back({op.object, op.kind, OrderedBox<Scalar, Dim>(op.box)});
    const std::map<ObjectId, Box<Scalar, Dim>> boxes_before = boxes_;
    const std::vector<PairKey> before = overlaps_;
    apply(ops);

    // A delta that is there already must stay: drain() appends.
    const OverlapDelta sentinel{PairKey(0, 1), 12345};
    DeltaList appended;
    appended.push_back(sentinel);
    const std::uint64_t counted = counters_.deltas;
    try {
      cell.drain(cell_ops, appended, counters_);
      if (appended.empty() || appended[0].pair != sentinel.pair || appended[0].change != sentinel.change) {
        return "drain() did not append to the deltas";
      }
      const std::vector<OverlapDelta> deltas(appended.begin() + 1, appended.end());
      if (counters_.deltas - counted != deltas.size()) return "the delta counter is not the number of deltas";
      for (const OverlapDelta& delta : deltas) {
        for (const ObjectId object : {delta.pair.lower(), delta.pair.upper()}) {
          if (boxes_.count(object) == 0 && boxes_before.count(object) == 0) {
            return "a delta names object " + std::to_string(object) + ", which is not in the cell";
          }
        }
      }
      std::string wrong = compare_deltas(before, deltas);
      if (wrong.empty()) wrong = compare_residents(cell);
      if (wrong.empty()) cell.validate();
      return wrong;
    } catch (const std::exception& error) {
      return std::string("exception: ") + error.what();
    }
  }

  /// Transfers `ops` and says what is wrong with the outcome. Compared: residents and boxes; validate(); the delta
  /// counter, which must stay as it is.
  std::string transfer(Cell& cell, std::span<const Op> ops) {
    std::vector<CellOp<Scalar, Dim>> cell_ops;
    for (const Op& op : ops) cell_ops.push_back({op.object, op.kind, OrderedBox<Scalar, Dim>(op.box)});
    apply(ops);
    const std::uint64_t counted = counters_.deltas;
    try {
      cell.transfer(cell_ops, counters_);
      if (counters_.deltas != counted) return "transfer() counts deltas";
      std::string wrong = compare_residents(cell);
      if (wrong.empty()) cell.validate();
      return wrong;
    } catch (const std::exception& error) {
      return std::string("exception: ") + error.what();
    }
  }

  /// Visits `cell` and says what is wrong with the outcome. Compared: that each changed pair has one delta, and no
  /// other has any; both counters.
  std::string visit(const Cell& cell, std::span<const BoxVisit<Scalar, Dim>> visits) {
    std::vector<typename Cell::Visit> cell_visits;
    std::map<PairKey, int> expected;
    std::uint64_t box_tests = 0;
    for (const auto& visit : visits) {
      cell_visits.push_back({visit.object, visit.was, visit.is, OrderedBox<Scalar, Dim>(visit.before),
                             OrderedBox<Scalar, Dim>(visit.after)});
      box_tests += boxes_.size() * ((visit.was ? 1 : 0) + (visit.is ? 1 : 0));
      for (const auto& [object, box] : boxes_) {
        const bool was = visit.was && visit.before.overlaps(box);
        const bool is = visit.is && visit.after.overlaps(box);
        if (was != is) expected[PairKey(object, visit.object)] = is ? +1 : -1;
      }
    }
    DeltaList deltas;
    deltas.push_back({});
    SapCounters counters;
    cell.visit(cell_visits, deltas, counters);
    if (counters.box_tests != box_tests) return "visit() miscounts the pairs that it compares";
    if (counters.deltas != expected.size()) return "visit() counts a wrong number of deltas";
    if (deltas.size() != expected.size() + 1) return "visit() gives a wrong number of deltas";
    for (std::size_t index = 1; index < deltas.size(); ++index) {
      const auto [pair, change] = deltas[index];
      const auto found = expected.find(pair);
      if (found == expected.end() || found->second != change) {
        return "visit() is wrong about pair (" + std::to_string(pair.lower()) + ", " + std::to_string(pair.upper()) +
               ")";
      }
      expected.erase(found);
    }
    return {};
  }

  [[nodiscard]] const std::map<ObjectId, Box<Scalar, Dim>>& boxes() const { return boxes_; }
  [[nodiscard]] const std::vector<PairKey>& overlaps() const { return overlaps_; }
  [[nodiscard]] const SapCounters& counters() const { return counters_; }

 private:
  void apply(std::span<const Op> ops) {
    for (const Op& op : ops) {
      if (op.kind == OpKind::kErase) {
        boxes_.erase(op.object);
      } else {
        boxes_.insert_or_assign(op.object, op.box);
      }
    }
    overlaps_.clear();  // stays sorted, for the map is
    std::vector<ObjectId> objects;
    std::vector<Box<Scalar, Dim>> boxes;
    for (const auto& [object, box] : boxes_) objects.push_back(object), boxes.push_back(box);
    every_overlap(boxes, [&](std::size_t a, std::size_t b) { overlaps_.emplace_back(objects[a], objects[b]); });
  }

  [[nodiscard]] std::string compare_deltas(const std::vector<PairKey>& before,
                                           const std::vector<OverlapDelta>& deltas) const {
    std::vector<PairKey> begun;
    std::vector<PairKey> ended;
    std::set_difference(overlaps_.begin(), overlaps_.end(), before.begin(), before.end(), std::back_inserter(begun));
    std::set_difference(before.begin(), before.end(), overlaps_.begin(), overlaps_.end(), std::back_inserter(ended));
    std::map<PairKey, int> missing;  // change of state minus what the cell said
    for (const PairKey pair : begun) ++missing[pair];
    for (const PairKey pair : ended) --missing[pair];
    for (const OverlapDelta& delta : deltas) missing[delta.pair] -= delta.change;
    for (const auto& [pair, change] : missing) {
      if (change == 0) continue;
      const bool was = std::binary_search(before.begin(), before.end(), pair);
      const bool is = std::binary_search(overlaps_.begin(), overlaps_.end(), pair);
      std::ostringstream text;
      text << "pair (" << pair.lower() << ", " << pair.upper() << "): overlap was " << was << ", is " << is
           << ", but the deltas sum to " << int{is} - int{was} - change;
      return text.str();
    }
    return {};
  }

  [[nodiscard]] std::string compare_residents(const Cell& cell) const {
    std::vector<typename Cell::Resident> residents;
    cell.append_residents(residents);
    if (residents.size() != boxes_.size() || cell.size() != boxes_.size()) return "the number of residents is wrong";
    std::map<ObjectId, OrderedBox<Scalar, Dim>> seen;
    for (const auto& resident : residents) seen.emplace(resident.object, resident.box);
    for (const auto& [object, box] : boxes_) {
      const auto found = seen.find(object);
      if (found == seen.end()) return "object " + std::to_string(object) + " is not among the residents";
      if (found->second != OrderedBox<Scalar, Dim>(box)) return "the box of object " + std::to_string(object);
    }
    return {};
  }

  std::map<ObjectId, Box<Scalar, Dim>> boxes_;
  std::vector<PairKey> overlaps_;
  SapCounters counters_;
};

}  // namespace sweepgrid::oracle
