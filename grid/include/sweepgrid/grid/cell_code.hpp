#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace sweepgrid {

template <int Dim>
using CellCoordinates = std::array<std::uint32_t, static_cast<std::size_t>(Dim)>;

/// A cell's coordinates as one 64-bit number: the upper bits name a block of neighbouring cells (4 x 4 x 4 in three
/// dimensions), the lower bits a cell in it.
template <int Dim>
struct CellCode {
  static constexpr int kAxisBits = std::min(21, 63 / Dim);
  static constexpr std::uint32_t kLastCoordinate = (std::uint32_t{1} << kAxisBits) - 1;
  static constexpr int kInnerBits = Dim <= 6 ? 6 / Dim : 0;  // of a coordinate, within a block
  static constexpr int kBlockShift = kInnerBits * Dim;
  static constexpr std::uint32_t kBlockCells = std::uint32_t{1} << kBlockShift;

  /// What a coordinate adds to the code. The parts of different axes share no bit.
  [[nodiscard]] static std::uint64_t part(int axis, std::uint32_t coordinate) {
    constexpr std::uint32_t kInner = (std::uint32_t{1} << kInnerBits) - 1;
    return std::uint64_t{coordinate >> kInnerBits} << (kBlockShift + axis * (kAxisBits - kInnerBits)) |
           std::uint64_t{coordinate & kInner} << (axis * kInnerBits);
  }

  [[nodiscard]] static std::uint64_t of(const CellCoordinates<Dim>& cell) {
    std::uint64_t code = 0;
    for (int axis = 0; axis < Dim; ++axis) code |= part(axis, cell[axis]);
    return code;
  }

  [[nodiscard]] static CellCoordinates<Dim> coordinates(std::uint64_t code) {
    constexpr std::uint64_t kInner = (std::uint64_t{1} << kInnerBits) - 1;
    constexpr std::uint64_t kOuter = (std::uint64_t{1} << (kAxisBits - kInnerBits)) - 1;
    CellCoordinates<Dim> cell;
    for (int axis = 0; axis < Dim; ++axis) {
      const std::uint64_t outer = code >> (kBlockShift + axis * (kAxisBits - kInnerBits)) & kOuter;
      cell[axis] = static_cast<std::uint32_t>(outer << kInnerBits | (code >> (axis * kInnerBits) & kInner));
    }
    return cell;
  }

  [[nodiscard]] static std::uint64_t block(std::uint64_t code) { return code >> kBlockShift; }
  [[nodiscard]] static std::uint32_t inner(std::uint64_t code) {
    return static_cast<std::uint32_t>(code & (kBlockCells - 1));
  }

  /// A well-mixed hash of a block: its upper bits choose a shard, its lower bits a bucket.
  [[nodiscard]] static std::uint64_t hash(std::uint64_t block) {
    std::uint64_t h = block * 0x9e3779b97f4a7c15U;
    h ^= h >> 32;
    return h * 0xd6e8feb86659fd93U;
  }
};

}  // namespace sweepgrid
