#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include <sweepgrid/engine/events.hpp>
#include <sweepgrid/engine/key_order.hpp>

namespace sweepgrid {

/// Sorts pairs of integers digit by digit, which takes no branch that nobody could foresee: a pair is packed into one
/// number that has only the bits in which the keys at hand differ, so dense keys take few passes whatever their type.
template <class Key>
class DigitSort {
 public:
  /// Whether `Order` puts keys into the order of their values, so that digits may be sorted by.
  template <class Order>
  static constexpr bool kFits =
      std::integral<Key> && !std::same_as<Key, bool> && sizeof(Key) <= 8 &&
      (std::same_as<Order, KeyOrder<Key>> || std::same_as<Order, std::less<Key>> || std::same_as<Order, std::less<>>);

  /// Sorts by first, then second. Returns false, and has done nothing, where comparing is cheaper or keys differ too
  /// widely. O(n) for a given spread of keys.
  static bool sort(std::span<Pair<Key>> pairs) {
    if (pairs.size() < kFewest) return false;
    const Spread first(pairs, &Pair<Key>::first);
    const Spread second(pairs, &Pair<Key>::second);
    const int bits = first.bits + second.bits;
    const int passes = (bits + kDigitBits - 1) / kDigitBits;
    if (passes > kMostPasses) return false;  // more than 55 bits
    std::vector<std::uint64_t> packed(2 * pairs.size());
    const auto from = std::span(packed).first(pairs.size());
    const auto to = std::span(packed).last(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      from[i] = first.rank(pairs[i].first) << second.bits | second.rank(pairs[i].second);
    }
    const auto sorted = sort_packed(from, to, bits, passes);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      pairs[i] = {first.key(sorted[i] >> second.bits), second.key(sorted[i] & second.mask())};
    }
    return true;
  }

 private:
  static constexpr std::size_t kFewest = 64;  // measured
  static constexpr int kDigitBits = 11;
  static constexpr int kMostPasses = 5;

  using Rank = std::make_unsigned_t<std::conditional_t<std::integral<Key> && !std::same_as<Key, bool>, Key, int>>;

  /// The keys on one side of the pairs, counted from the least.
  struct Spread {
    Spread(std::span<const Pair<Key>> pairs, Key Pair<Key>::*side) : least(pairs[0].*side) {
      Key most = least;
      for (const Pair<Key>& pair : pairs) least = std::min(least, pair.*side), most = std::max(most, pair.*side);
      bits = std::max(1, static_cast<int>(std::bit_width(rank(most))));  // 0 would be too small for a digit
    }
    [[nodiscard]] std::uint64_t rank(Key key) const {
      return static_cast<Rank>(static_cast<Rank>(key) - static_cast<Rank>(least));
    }
    [[nodiscard]] Key key(std::uint64_t rank) const {
      return static_cast<Key>(static_cast<Rank>(static_cast<Rank>(least) + static_cast<Rank>(rank)));
    }
    [[nodiscard]] std::uint64_t mask() const { return (std::uint64_t{1} << bits) - 1; }

    Key least;
    int bits;
  };

  // Least digit first; returns which of the two holds the result.
  static std::span<const std::uint64_t> sort_packed(std::span<std::uint64_t> from, std::span<std::uint64_t> to,
                                                    int bits, int passes) {
    const int digit_bits = (bits + passes - 1) / passes;
    const std::uint64_t mask = (std::uint64_t{1} << digit_bits) - 1;
    std::array<std::uint32_t, std::size_t{1} << kDigitBits> ends;
    for (int shift = 0; shift < bits; shift += digit_bits) {
      std::fill_n(ends.begin(), mask + 1, 0);
      for (const std::uint64_t pair : from) ++ends[pair >> shift & mask];
      std::uint32_t begin = 0;
      for (std::size_t digit = 0; digit <= mask; ++digit) begin += std::exchange(ends[digit], begin);
      // Each entry walks from its digit's begin to its end.
      for (const std::uint64_t pair : from) to[ends[pair >> shift & mask]++] = pair;
      std::swap(from, to);
    }
    return from;
  }
};

}  // namespace sweepgrid
