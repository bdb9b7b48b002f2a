#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <ostream>
#include <string>

#include "../watched_heap.hpp"

namespace sweepgrid::fuzz {

/// A client's own key: its copies allocate, and its hash may throw.
struct TextKey {
  std::string text;

  friend bool operator==(const TextKey&, const TextKey&) = default;
  friend auto operator<=>(const TextKey& a, const TextKey& b) { return a.text <=> b.text; }
  friend std::ostream& operator<<(std::ostream& out, const TextKey& key) { return out << key.text; }
};

struct TextKeyHash {
  std::size_t operator()(const TextKey& key) const {
    heap::may_fail();
    return std::hash<std::string>()(key.text);
  }
};

/// The key with a number: small and large ones, in an order that is not that of the numbers.
template <class Key>
Key make_key(std::size_t number);

template <>
inline std::uint64_t make_key(std::size_t number) {
  return number % 2 == 0 ? number : ~std::uint64_t{number};
}

template <>
inline TextKey make_key(std::size_t number) {
  return {"an object whose name is longer than a string holds in place, " + std::to_string(number * 7 % 41)};
}

}  // namespace sweepgrid::fuzz
