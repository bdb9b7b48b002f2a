#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <sweepgrid/sap/cell_kind.hpp>

#include "accuracy/pair_log.hpp"
#include "baselines/peer_system.hpp"

namespace sweepgrid::accuracy {

/// One cell without a grid around it. That its overlap deltas are netted to events is part of the step.
class CellSystem final : public baselines::System {
 public:
  explicit CellSystem(const CellOptions& options) : cell_(make_cell<float, 3>(options)) {}

  /// Like a cell, it does not look at what it is given: boxes must be valid, and numbers right.
  void queue(const ScriptStep& step) override;
  void step() override;

  [[nodiscard]] std::vector<baselines::ObjectPair> pairs() const override { return log_.pairs(); }
  [[nodiscard]] std::optional<baselines::EventTotals> events() const override { return totals_; }
  [[nodiscard]] std::optional<std::uint64_t> counted_bytes() const override { return cell_->bytes(); }

 private:
  std::unique_ptr<SweepAndPrune<float, 3>> cell_;
  std::vector<CellOp<float, 3>> ops_;
  DeltaList deltas_;
  SapCounters counters_;
  PairLog log_;
  baselines::EventTotals totals_;
};

}  // namespace sweepgrid::accuracy
