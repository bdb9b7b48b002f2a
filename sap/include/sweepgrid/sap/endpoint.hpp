#pragma once

#include <compare>
#include <cstdint>
#include <type_traits>

#include <sweepgrid/sap/ordered_box.hpp>

namespace sweepgrid {

/// An object's number inside one cell (the paper's integer key per cell, section 3.1): small, reused, stable while the
/// object stays.
using Slot = std::uint32_t;

/// A box's min or max on one axis (the paper's extremum): value, side and owner in one integer.
///
/// Integer comparison is the strict total order of all interval lists: by value, then min before max, then by owner.
/// Min before max at equal values makes boxes closed; the owner only breaks ties that no overlap depends on.
template <class Scalar>
class Endpoint {
 public:
  using Bits = OrderedBits<Scalar>;

  Endpoint() = default;
  static Endpoint min_of(Slot owner, Bits value) { return Endpoint(value, owner); }
  static Endpoint max_of(Slot owner, Bits value) { return Endpoint(value, owner | kMaxBit); }

  [[nodiscard]] Bits value() const { return static_cast<Bits>(packed_ >> 32); }
  [[nodiscard]] Slot owner() const { return static_cast<std::uint32_t>(packed_) & ~kMaxBit; }
  [[nodiscard]] bool is_max() const { return (static_cast<std::uint32_t>(packed_) & kMaxBit) != 0; }

  friend auto operator<=>(Endpoint, Endpoint) = default;

 private:
  __extension__ using Wide = unsigned __int128;
  using Packed = std::conditional_t<sizeof(Bits) == 4, std::uint64_t, Wide>;
  static constexpr std::uint32_t kMaxBit = 0x80000000U;

  Endpoint(Bits value, std::uint32_t tag) : packed_(static_cast<Packed>(value) << 32 | tag) {}

  Packed packed_ = 0;
};

/// A cell holds at most this many objects: the side takes one bit of an endpoint's owner.
inline constexpr std::uint32_t kMaxSlots = 0x7fffffffU;

}  // namespace sweepgrid
