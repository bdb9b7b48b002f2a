#pragma once

#include <concepts>
#include <functional>

namespace sweepgrid {

/// The order of keys in which events are sorted unless the client names another: operator<. A key without one needs an
/// Order of its own, or events could not be the same for every thread count.
template <class Key>
struct KeyOrder {
  static_assert(
      requires(const Key& a, const Key& b) {
        { a < b } -> std::convertible_to<bool>;
      },
      "sweepgrid: the key has no operator<; name a total order as Engine's last template argument");

  bool operator()(const Key& a, const Key& b) const { return a < b; }
};

/// Whether `Order` is known to be that of the values.
template <class Key, class Order>
inline constexpr bool kByValue =
    std::same_as<Order, KeyOrder<Key>> || std::same_as<Order, std::less<Key>> || std::same_as<Order, std::less<>>;

}  // namespace sweepgrid
