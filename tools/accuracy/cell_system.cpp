#include "accuracy/cell_system.hpp"

#include <algorithm>

namespace sweepgrid::accuracy {

void CellSystem::queue(const ScriptStep& step) {
  for (const std::uint32_t object : step.erased) ops_.push_back({object, OpKind::kErase, {}});
  for (std::size_t i = 0; i < step.inserted.size(); ++i) {
    ops_.push_back({step.inserted[i], OpKind::kInsert, OrderedBox<float, 3>(step.inserted_boxes[i])});
  }
  for (std::size_t i = 0; i < step.updated.size(); ++i) {
    ops_.push_back({step.updated[i], OpKind::kUpdate, OrderedBox<float, 3>(step.updated_boxes[i])});
  }
}

void CellSystem::step() {
  deltas_.clear();
  cell_->drain(ops_, deltas_, counters_);
  ops_.clear();
  std::sort(deltas_.begin(), deltas_.end(),
            [](const OverlapDelta& a, const OverlapDelta& b) { return a.pair < b.pair; });
  for (auto delta = deltas_.begin(); delta != deltas_.end();) {
    const PairKey pair = delta->pair;
    int sum = 0;
    for (; delta != deltas_.end() && delta->pair == pair; ++delta) sum += delta->change;
    if (sum > 0) ++totals_.begins, log_.begin(pair);
    if (sum < 0) ++totals_.ends, log_.end(pair);
  }
}

}  // namespace sweepgrid::accuracy
