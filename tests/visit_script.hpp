#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "op_script.hpp"
#include "sap_oracle.hpp"

/// Drains, transfers and visits by turns.
namespace sweepgrid::oracle {

/// Writes visits of objects that come, move and go; their ids are never those of an OpScript's residents.
template <class Scalar, int Dim>
class VisitScript {
 public:
  VisitScript(Palette palette, std::uint64_t seed)
      : script_(
            Regime{.name = "visitors", .palette = palette, .population = 12, .moving_percent = 80, .churn_percent = 30},
            seed) {}

  std::vector<BoxVisit<Scalar, Dim>> next() {
    std::vector<BoxVisit<Scalar, Dim>> visits;
    for (const auto& op : script_.next()) {
      BoxVisit<Scalar, Dim> visit{.object = op.object ^ 0x40000000U};
      if (op.kind != OpKind::kInsert) {
        visit.was = true;
        visit.before = boxes_.at(op.object);
      }
      if (op.kind != OpKind::kErase) {
        visit.is = true;
        visit.after = op.box;
        boxes_[op.object] = op.box;
      }
      visits.push_back(visit);
    }
    return visits;
  }

 private:
  OpScript<Scalar, Dim> script_;
  std::map<ObjectId, Box<Scalar, Dim>> boxes_;
};

template <class Scalar, int Dim>
bool is_transfer(const BoxOp<Scalar, Dim>& op) {
  return op.kind != OpKind::kUpdate;
}

/// Plays a script of ops, where in every third step the inserts and erases are a transfer, and a script of visits to an
/// empty cell. Says what went wrong first; nothing if all is well. `oracle` must be new, too, and knows the counters
/// afterwards.
template <class Scalar, int Dim>
std::string play_visits(SweepAndPrune<Scalar, Dim>& cell, CellOracle<Scalar, Dim>& oracle, const Regime& regime,
                        std::uint64_t seed) {
  OpScript<Scalar, Dim> script(regime, seed);
  VisitScript<Scalar, Dim> visitors(regime.palette, seed + 1);
  for (int step = 0; step < regime.drains; ++step) {
    Drain<Scalar, Dim> ops = script.next();
    std::string wrong;
    if (step % 3 == 1) {
      Drain<Scalar, Dim> transfers;
      std::copy_if(ops.begin(), ops.end(), std::back_inserter(transfers), is_transfer<Scalar, Dim>);
      std::erase_if(ops, is_transfer<Scalar, Dim>);
      wrong = oracle.transfer(cell, transfers);
    }
    if (wrong.empty()) wrong = oracle.drain(cell, ops);
    if (wrong.empty()) wrong = oracle.visit(cell, visitors.next());
    if (!wrong.empty()) {
      return std::string("regime ") + regime.name + ", population " + std::to_string(regime.population) + ", step " +
             std::to_string(step) + ": " + wrong;
    }
  }
  return {};
}

}  // namespace sweepgrid::oracle
