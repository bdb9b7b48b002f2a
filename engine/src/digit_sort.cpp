#include <sweepgrid/engine/digit_sort.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace sweepgrid {
namespace {

constexpr std::size_t kFewest = 64;  // measured
constexpr int kDigitBits = 11;
constexpr int kMostPasses = 5;

/// The ranks on one side of the pairs, counted from the least.
struct Spread {
  Spread(std::span<const RankPair> pairs, std::uint64_t RankPair::*side) : least(pairs[0].*side) {
    std::uint64_t most = least;
    for (const RankPair& pair : pairs) least = std::min(least, pair.*side), most = std::max(most, pair.*side);
    bits = std::max(1, static_cast<int>(std::bit_width(most - least)));  // 0 would be too small for a digit
  }
  [[nodiscard]] std::uint64_t mask() const { return (std::uint64_t{1} << bits) - 1; }

  std::uint64_t least;
  int bits;
};

// Least digit first; returns which of the two holds the result.
std::span<const std::uint64_t> sort_packed(std::span<std::uint64_t> from, std::span<std::uint64_t> to, int bits,
                                           int passes) {
  const int digit_bits = (bits + passes - 1) / passes;
  const std::uint64_t mask = (std::uint64_t{1} << digit_bits) - 1;
  std::array<std::size_t, std::size_t{1} << kDigitBits> ends;
  for (int shift = 0; shift < bits; shift += digit_bits) {
    std::fill_n(ends.begin(), mask + 1, 0);
    for (const std::uint64_t pair : from) ++ends[pair >> shift & mask];
    std::size_t begin = 0;
    for (std::size_t digit = 0; digit <= mask; ++digit) begin += std::exchange(ends[digit], begin);
    // Each entry walks from its digit's begin to its end.
    for (const std::uint64_t pair : from) to[ends[pair >> shift & mask]++] = pair;
    std::swap(from, to);
  }
  return from;
}

}  // namespace

void DigitSort::sort(std::span<RankPair> pairs) {
  const auto compare = [&] {
    std::sort(pairs.begin(), pairs.end(), [](const RankPair& a, const RankPair& b) {
      return a.first < b.first || (a.first == b.first && a.second < b.second);
    });
  };
  if (pairs.size() < kFewest) return compare();
  const Spread first(pairs, &RankPair::first);
  const Spread second(pairs, &RankPair::second);
  const int bits = first.bits + second.bits;
  const int passes = (bits + kDigitBits - 1) / kDigitBits;
  if (passes > kMostPasses) return compare();
  packed_.resize(2 * pairs.size());
  const auto from = std::span(packed_).first(pairs.size());
  const auto to = std::span(packed_).last(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    from[i] = (pairs[i].first - first.least) << second.bits | (pairs[i].second - second.least);
  }
  const auto sorted = sort_packed(from, to, bits, passes);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i] = {(sorted[i] >> second.bits) + first.least, (sorted[i] & second.mask()) + second.least};
  }
}

}  // namespace sweepgrid
