#pragma once

#include <compare>
#include <cstdint>

#include <sweepgrid/sap/platform.hpp>

namespace sweepgrid {

/// Dense number of an object inside the engine. Never seen by clients, who hold keys and handles.
using ObjectId = std::uint32_t;

/// No object has this id, so at most 2^32 - 1 objects exist at a time.
inline constexpr ObjectId kNoObject = 0xffffffffU;

/// An unordered pair of two distinct objects as one 64-bit number, the lower id in the upper half.
class PairKey {
 public:
  PairKey() = default;
  PairKey(ObjectId a, ObjectId b) : bits_(a < b ? std::uint64_t{a} << 32 | b : std::uint64_t{b} << 32 | a) {}

  [[nodiscard]] ObjectId lower() const { return static_cast<ObjectId>(bits_ >> 32); }
  [[nodiscard]] ObjectId upper() const { return static_cast<ObjectId>(bits_); }
  [[nodiscard]] std::uint64_t bits() const { return bits_; }

  friend auto operator<=>(PairKey, PairKey) = default;

 private:
  std::uint64_t bits_ = 0;
};

}  // namespace sweepgrid
