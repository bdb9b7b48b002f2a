#pragma once

#include <vector>

namespace sweepgrid {

/// Two distinct objects by key; `first` precedes `second` in key order.
template <class Key>
struct Pair {
  Key first;
  Key second;

  friend bool operator==(const Pair&, const Pair&) = default;
};

/// The net change of the set of overlapping pairs over one step. Both lists are sorted by (first, second) in key order
/// and hold no pair twice. A client applies `ends` before `begins`: a key that was erased and inserted again within the
/// step ends its old pairs and begins its new ones, which may be the same keys. No other pair is in both lists.
template <class Key>
struct Events {
  std::vector<Pair<Key>> ends;
  std::vector<Pair<Key>> begins;

  friend bool operator==(const Events&, const Events&) = default;
};

}  // namespace sweepgrid
