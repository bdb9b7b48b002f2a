#pragma once

#include <cstdint>

#include <sweepgrid/sap/ids.hpp>

namespace sweepgrid {

/// One cell's word that a pair began (+1) or ceased (-1) to overlap there. The deltas of one drain may name a pair
/// several times; their sum is the pair's state after the drain minus its state before.
struct OverlapDelta {
  PairKey pair;
  std::int32_t change = 0;
};

}  // namespace sweepgrid
