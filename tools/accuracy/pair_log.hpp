#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include <sweepgrid/sap/ids.hpp>

#include "baselines/peer_system.hpp"

namespace sweepgrid::accuracy {

/// The pairs of a system that only tells what changes. Taking a change down is an append, so that a timed step pays
/// next to nothing; pairs() does the rest.
class PairLog {
 public:
  void begin(PairKey pair) { changes_.emplace_back(pair, +1); }
  void end(PairKey pair) { changes_.emplace_back(pair, -1); }

  [[nodiscard]] std::vector<baselines::ObjectPair> pairs() const {
    settle();
    std::vector<baselines::ObjectPair> result;
    result.reserve(settled_.size());
    for (const auto& [pair, count] : settled_) {
      for (std::int32_t i = 0; i < count; ++i) result.push_back({pair.lower(), pair.upper()});  // once, if all is right
    }
    return result;
  }

 private:
  using Change = std::pair<PairKey, std::int32_t>;

  void settle() const {
    settled_.insert(settled_.end(), changes_.begin(), changes_.end());
    changes_.clear();
    std::sort(settled_.begin(), settled_.end());
    auto out = settled_.begin();
    for (auto in = settled_.begin(); in != settled_.end();) {
      Change sum{in->first, 0};
      for (; in != settled_.end() && in->first == sum.first; ++in) sum.second += in->second;
      if (sum.second != 0) *out++ = sum;
    }
    settled_.erase(out, settled_.end());
  }

  // What is known does not change when changes are summed up.
  mutable std::vector<Change> settled_;  // sorted
  mutable std::vector<Change> changes_;
};

}  // namespace sweepgrid::accuracy
