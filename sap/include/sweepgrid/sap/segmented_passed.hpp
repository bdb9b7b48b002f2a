#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <sweepgrid/sap/endpoint.hpp>

namespace sweepgrid {

/// The endpoints that one endpoint changed places with, of which those of the other side matter: noted without a
/// branch, because whether an endpoint is a min or a max cannot be predicted, and tested later.
template <class Scalar>
class SegmentedPassed {
 public:
  using End = Endpoint<Scalar>;

  explicit SegmentedPassed(End mover) : mover_(mover) {}

  [[nodiscard]] Slot mover() const { return mover_.owner(); }

  /// Endpoints that can be added before clear().
  [[nodiscard]] std::uint32_t room() const { return static_cast<std::uint32_t>(owners_.size()) - swaps_; }

  void add(End end) {
    owners_[opposite_] = end.owner();
    opposite_ += std::uint32_t{end.is_max() != mover_.is_max()};
    ++swaps_;
  }

  [[nodiscard]] std::uint32_t swaps() const { return swaps_; }

  /// Owners of the endpoints of the other side.
  [[nodiscard]] std::span<const Slot> opposite() const { return {owners_.data(), opposite_}; }

  void clear() { swaps_ = opposite_ = 0; }

 private:
  End mover_;
  std::uint32_t swaps_ = 0;
  std::uint32_t opposite_ = 0;
  std::array<Slot, 64> owners_;
};

}  // namespace sweepgrid
