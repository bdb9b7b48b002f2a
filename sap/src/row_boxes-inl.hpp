// Boxes in vectors, for one instruction set at a time: included by row_kernels.cpp once for each.
#if defined(SWEEPGRID_ROW_BOXES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SWEEPGRID_ROW_BOXES_INL
#undef SWEEPGRID_ROW_BOXES_INL
#else
#define SWEEPGRID_ROW_BOXES_INL
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include <sweepgrid/sap/row_block.hpp>

HWY_BEFORE_NAMESPACE();
namespace sweepgrid::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// A set of lanes, one bit each.
using Lanes = std::uint32_t;
constexpr std::uint32_t kMaxLanes = 16;

/// The lanes that stand for places below `end`, where lane 0 stands for place `first`.
HWY_INLINE Lanes lanes_below(std::uint32_t first, std::uint32_t end) {
  return end <= first ? 0 : end - first >= 32 ? ~Lanes{0} : (Lanes{1} << (end - first)) - 1;
}

template <class D, class Mask>
HWY_INLINE Lanes lanes_of(D d, Mask mask) {
  std::uint8_t bytes[8];
  hn::StoreMaskBits(d, mask, bytes);
  if constexpr (hn::MaxLanes(D()) > 8) {
    std::uint16_t lanes;
    std::memcpy(&lanes, bytes, sizeof(lanes));
    return lanes;
  } else {
    return bytes[0];
  }
}

/// One vector for each row of values: the boxes of neighbouring places, or one box in every lane.
/// Loops over rows are folds, because the compiler unrolls loops too late to keep the array in registers.
template <class Bits, int Dim>
class Boxes {
 public:
  using Block = RowBlock<Bits, Dim>;
  using Value = typename Block::Value;
  using D = hn::CappedTag<Value, kMaxLanes>;
  using V = hn::Vec<D>;
  static constexpr std::uint32_t kLanes = hn::MaxLanes(D());
  static constexpr Lanes kAll = (Lanes{1} << kLanes) - 1;

  /// The boxes at `first` and the next places.
  static HWY_INLINE Boxes load(const Block& block, std::uint32_t first) { return load(block, first, Rows()); }

  /// The box at `place` in every lane.
  static HWY_INLINE Boxes at(const Block& block, std::uint32_t place) { return at(block, place, Rows()); }

  /// A box that lies elsewhere, Dim mins and then Dim maxes, in every lane.
  static HWY_INLINE Boxes everywhere(const Bits* box) { return everywhere(box, Rows()); }

  /// Replaces the box in `lane`, and none if there is no such lane.
  HWY_INLINE void set(std::uint32_t lane, const Boxes& box) {
    set(hn::Eq(hn::Iota(D(), 0), hn::Set(D(), static_cast<Value>(lane))), box, Rows());
  }

  /// Writes to `first` and the next places, and beyond the end of each row. It goes from row to row, so that what
  /// belongs to the next row is right in the end.
  HWY_INLINE void store(Block& block, std::uint32_t first) const { store(block, first, Rows()); }

  /// The lanes whose boxes overlap.
  HWY_INLINE Lanes overlaps(const Boxes& other) const {
#if HWY_TARGET <= HWY_AVX3
    return lanes_of(D(), hn::Eq(apart_from<0>(other), hn::Zero(D())));
#else
    return ~lanes_of(D(), apart_from<0>(other)) & kAll;
#endif
  }

 private:
  using Rows = std::make_index_sequence<Block::kValueRows>;

  template <std::size_t... kRow>
  static HWY_INLINE Boxes load(const Block& block, std::uint32_t first, std::index_sequence<kRow...>) {
    return Boxes{hn::LoadU(D(), block.row(kRow) + first)...};
  }

  template <std::size_t... kRow>
  static HWY_INLINE Boxes at(const Block& block, std::uint32_t place, std::index_sequence<kRow...>) {
    return Boxes{hn::Set(D(), block.row(kRow)[place])...};
  }

  template <std::size_t... kRow>
  static HWY_INLINE Boxes everywhere(const Bits* box, std::index_sequence<kRow...>) {
    const V flip = hn::Set(D(), static_cast<Value>(Block::kFlip));
    return Boxes{hn::Xor(hn::Set(D(), static_cast<Value>(box[kRow])), flip)...};
  }

  template <class Mask, std::size_t... kRow>
  HWY_INLINE void set(Mask lane, const Boxes& box, std::index_sequence<kRow...>) {
    ((rows_[kRow] = hn::IfThenElse(lane, box.rows_[kRow], rows_[kRow])), ...);
  }

  template <std::size_t... kRow>
  HWY_INLINE void store(Block& block, std::uint32_t first, std::index_sequence<kRow...>) const {
    (hn::StoreU(rows_[kRow], D(), block.row(kRow) + first), ...);
  }

  /// Says on which lanes the boxes are apart on one of the axes from kAxis on.
  template <int kAxis>
  HWY_INLINE auto apart_from(const Boxes& other) const {
    const V min = rows_[kAxis];
    const V max = rows_[Dim + kAxis];
    const V other_min = other.rows_[kAxis];
    const V other_max = other.rows_[Dim + kAxis];
#if HWY_TARGET <= HWY_AVX3
    // x <= y exactly where max(x, y) ^ y is 0. Comparing would make masks, and those have fewer units.
    const auto apart = hn::Or(hn::Xor(hn::Max(min, other_max), other_max), hn::Xor(hn::Max(other_min, max), max));
#else
    const auto apart = hn::Or(hn::Gt(min, other_max), hn::Gt(other_min, max));
#endif
    if constexpr (kAxis + 1 < Dim) {
      return hn::Or(apart, apart_from<kAxis + 1>(other));
    } else {
      return apart;
    }
  }

  template <class... Row>
  explicit HWY_INLINE Boxes(Row... rows) : rows_{rows...} {}

  V rows_[Block::kValueRows];
};

}  // namespace sweepgrid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SWEEPGRID_ROW_BOXES_INL
