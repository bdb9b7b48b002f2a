#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <sweepgrid/engine/key_table.hpp>
#include <sweepgrid/sap/ids.hpp>

namespace sweepgrid {

/// Pairs as their keys, to be compared in the order of keys: for checks.
class KeyedPairs {
 public:
  struct Entry {
    const void* first;
    const void* second;
  };

  /// Those of a std::vector<Pair<Key>>, as they are.
  KeyedPairs(const KeyTable& keys, const void* list);
  /// Those of objects, sorted.
  KeyedPairs(const KeyTable& keys, std::span<const PairKey> pairs);

  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] const Entry& operator[](std::size_t i) const { return entries_[i]; }
  /// Place of the first entry that is not less than the next one; size() if there is none.
  [[nodiscard]] std::size_t first_unordered() const;
  /// Precondition: sorted. O(log n).
  [[nodiscard]] bool contains(const Entry& pair) const;
  [[nodiscard]] std::string describe(std::size_t i) const;

 private:
  [[nodiscard]] bool less(const Entry& a, const Entry& b) const;

  const KeyTable& keys_;
  std::vector<Entry> entries_;
};

}  // namespace sweepgrid
