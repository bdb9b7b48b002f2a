// Compiled several times over, once for each instruction set: foreach_target.h includes this file again and again.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "row_sweep.cpp"  // NOLINT(bugprone-suspicious-include): that is how Highway works
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <utility>

#include <sweepgrid/sap/row_sweep.hpp>

#ifndef SWEEPGRID_ROW_SWEEP_ONCE
#define SWEEPGRID_ROW_SWEEP_ONCE
namespace sweepgrid {

/// Calls SWEEPGRID_ROW_SWEEP for every type and number of axes that sweeps are compiled for.
#define SWEEPGRID_ALL_ROW_SWEEPS \
  SWEEPGRID_ROW_SWEEP(float, 1)  \
  SWEEPGRID_ROW_SWEEP(float, 2)  \
  SWEEPGRID_ROW_SWEEP(float, 3)  \
  SWEEPGRID_ROW_SWEEP(float, 4)  \
  SWEEPGRID_ROW_SWEEP(double, 1) \
  SWEEPGRID_ROW_SWEEP(double, 2) SWEEPGRID_ROW_SWEEP(double, 3) SWEEPGRID_ROW_SWEEP(double, 4)

}  // namespace sweepgrid
#endif  // SWEEPGRID_ROW_SWEEP_ONCE

HWY_BEFORE_NAMESPACE();
namespace sweepgrid::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Boxes in tiles of as many as a vector has lanes: for each value of a box a vector.
template <class Value, int Dim>
class Tiles {
 public:
  static constexpr std::uint32_t kMaxLanes = 16;
  using D = hn::CappedTag<Value, kMaxLanes>;
  using V = hn::Vec<D>;
  static constexpr std::uint32_t kLanes = hn::MaxLanes(D());
  static constexpr std::size_t kTile = 4 * Dim * kLanes;  // values

#if HWY_TARGET == HWY_SCALAR
  static void load(const Value* const* boxes, Value* tile) { std::copy_n(*boxes, kTile, tile); }
#else
  /// Of the values [kPart * n, kPart * n + n) of each box, where n values are 128 bits, a vector each.
  template <int kPart>
  static HWY_INLINE void load_part(const Value* const* boxes, Value* tile) {
    const D d;
    constexpr int kWide = 16 / sizeof(Value);
    V rows[kWide];
    for (int row = 0; row < kWide; ++row) {
      rows[row] = hn::LoadDup128(d, boxes[row] + kPart * kWide);
      for (std::uint32_t block = 1; block < kLanes / kWide; ++block) {
        const auto there = hn::LoadDup128(d, boxes[block * kWide + row] + kPart * kWide);
        rows[row] = hn::IfThenElse(in_block(block), there, rows[row]);
      }
    }
    Value* const to = tile + kPart * kWide * kLanes;
    if constexpr (kWide == 2) {
      hn::Store(hn::InterleaveLower(d, rows[0], rows[1]), d, to);
      hn::Store(hn::InterleaveUpper(d, rows[0], rows[1]), d, to + kLanes);
    } else {
      const hn::Repartition<double, D> wide;
      const auto low01 = hn::BitCast(wide, hn::InterleaveLower(d, rows[0], rows[1]));
      const auto high01 = hn::BitCast(wide, hn::InterleaveUpper(d, rows[0], rows[1]));
      const auto low23 = hn::BitCast(wide, hn::InterleaveLower(d, rows[2], rows[3]));
      const auto high23 = hn::BitCast(wide, hn::InterleaveUpper(d, rows[2], rows[3]));
      hn::Store(hn::BitCast(d, hn::InterleaveLower(wide, low01, low23)), d, to);
      hn::Store(hn::BitCast(d, hn::InterleaveUpper(wide, low01, low23)), d, to + kLanes);
      hn::Store(hn::BitCast(d, hn::InterleaveLower(wide, high01, high23)), d, to + 2 * kLanes);
      hn::Store(hn::BitCast(d, hn::InterleaveUpper(wide, high01, high23)), d, to + 3 * kLanes);
    }
  }

  /// The lanes of a block of 128 bits.
  static HWY_INLINE auto in_block(std::uint32_t block) {
    const hn::RebindToUnsigned<D> bits;
    using Bits = hn::TFromD<decltype(bits)>;
    constexpr int kShift = sizeof(Value) == 4 ? 2 : 1;
    return hn::RebindMask(D(),
                          hn::Eq(hn::ShiftRight<kShift>(hn::Iota(bits, 0)), hn::Set(bits, static_cast<Bits>(block))));
  }

  template <std::size_t... kPart>
  static HWY_INLINE void load(const Value* const* boxes, Value* tile, std::index_sequence<kPart...>) {
    (load_part<kPart>(boxes, tile), ...);
  }
  static HWY_INLINE void load(const Value* const* boxes, Value* tile) {
    load(boxes, tile, std::make_index_sequence<4 * Dim * sizeof(Value) / 16>());
  }
#endif
};

/// In which rows objects are.
template <class Value, int Dim>
class Placing {
 public:
  Placing(const RowCut<Value, Dim>& cut, typename RowSweep<Value, Dim>::Entries& entries)
      : cut_(cut), entries_(entries) {
    for (int axis = 0, used = 0; axis < Dim; ++axis) {
      if (axis != cut.along) row_axes_[used++] = axis;
    }
  }

  std::size_t run(const Value** boxes, std::uint32_t* objects, std::uint32_t count, std::uint32_t* far) {
    std::fill(boxes + count, boxes + count + Tile::kMaxLanes, kBoxOfNobody<Value>.data());
    std::size_t left_out = 0;
    entries_.count = 0;
    for (std::uint32_t first = 0; first < count; first += Tile::kLanes) {
      alignas(64) Value tile[Tile::kTile];
      Tile::load(boxes + first, tile);
      const Cells cells(tile, cut_);
      std::uint32_t far_lanes = put(cells, objects + first, count - first);
      for (; far_lanes != 0; far_lanes &= far_lanes - 1) {
        far[left_out++] = first + static_cast<std::uint32_t>(std::countr_zero(far_lanes));
      }
    }
    return left_out;
  }

 private:
  using Tile = Tiles<Value, Dim>;
  using D = typename Tile::D;
  using V = typename Tile::V;
  using I = hn::Rebind<std::int32_t, D>;
  using U = hn::Rebind<std::uint32_t, D>;
  using Numbers = hn::Vec<I>;

  /// The cells of what holds both sides of each box.
  struct Cells {
    HWY_INLINE Cells(const Value* tile, const RowCut<Value, Dim>& cut) {
      const D d;
      const auto value = [&](int index) HWY_ATTR { return hn::Load(d, tile + index * Tile::kLanes); };
      const V min0 = value(0);
      const V old_min0 = value(2 * Dim);
      const auto is = hn::Eq(min0, min0);  // not NaN
      const auto was = hn::Eq(old_min0, old_min0);
      for (int axis = 0; axis < Dim; ++axis) {
        const V min = value(axis);
        const V max = value(Dim + axis);
        const V old_min = value(2 * Dim + axis);
        const V old_max = value(3 * Dim + axis);
        const V lower = hn::Min(hn::IfThenElse(is, min, old_min), hn::IfThenElse(was, old_min, min));
        const V upper = hn::Max(hn::IfThenElse(is, max, old_max), hn::IfThenElse(was, old_max, max));
        hn::Store(cell(lower, axis, cut), I(), low + axis * Tile::kLanes);
        hn::Store(cell(upper, axis, cut), I(), high + axis * Tile::kLanes);
      }
    }
    static HWY_INLINE Numbers cell(V value, int axis, const RowCut<Value, Dim>& cut) {
      const D d;
      V place = hn::Mul(value, hn::Set(d, cut.scale[axis]));
      place = hn::Add(place, hn::Set(d, cut.offset[axis]));
      place = hn::Min(hn::Max(place, hn::Zero(d)), hn::Set(d, cut.last[axis]));
      if constexpr (sizeof(Value) == 4) {
        return hn::ConvertTo(I(), place);
      } else {
        return hn::DemoteTo(I(), place);
      }
    }
    alignas(64) std::int32_t low[Dim * Tile::kLanes];
    alignas(64) std::int32_t high[Dim * Tile::kLanes];
  };

  /// Appends the entries of the first `count` lanes; returns those that are left out.
  HWY_INLINE std::uint32_t put(const Cells& cells, const std::uint32_t* objects, std::uint32_t count) {
    const I i;
    const U u;
    const auto low = [&](int axis) HWY_ATTR { return hn::Load(i, cells.low + axis * Tile::kLanes); };
    const auto high = [&](int axis) HWY_ATTR { return hn::Load(i, cells.high + axis * Tile::kLanes); };
    const auto there = hn::FirstN(u, count);
    const auto bin = hn::BitCast(u, low(cut_.along));
    const auto last = high(cut_.along);
    const auto few_bins = hn::Set(i, RowSweep<Value, Dim>::kFewBins);
    auto many = hn::RebindMask(u, hn::Gt(hn::Sub(last, low(cut_.along)), few_bins));
    const auto reach = hn::ShiftLeft<row_marks::kBits>(hn::BitCast(u, last));
    const auto object = hn::LoadU(u, objects);
    auto row = hn::Zero(u);
    hn::Mask<U> two[kRowAxes + 1];
    for (int axis = 0; axis < kRowAxes; ++axis) {
      const auto from = low(row_axes_[axis]);
      const auto more = hn::Sub(high(row_axes_[axis]), from);
      row = hn::Add(row, hn::Mul(hn::BitCast(u, from), hn::Set(u, stride(axis))));
      two[axis] = hn::RebindMask(u, hn::Gt(more, hn::Zero(i)));
      many = hn::Or(many, hn::RebindMask(u, hn::Gt(more, hn::Set(i, 1))));
    }
    const auto few = hn::AndNot(many, there);
    std::size_t at = entries_.count;
    for (std::uint32_t corner = 0; corner < kCorners; ++corner) {
      auto mask = few;
      std::uint32_t further = 0;
      for (int axis = 0; axis < kRowAxes; ++axis) {
        if ((corner >> axis & 1) == 0) continue;
        mask = hn::And(mask, two[axis]);
        further += stride(axis);
      }
      hn::StoreU(hn::Compress(hn::Add(row, hn::Set(u, further)), mask), u, entries_.row + at);
      hn::StoreU(hn::Compress(bin, mask), u, entries_.bin + at);
      hn::StoreU(hn::Compress(object, mask), u, entries_.object + at);
      const auto marked = hn::Or(reach, hn::Set(u, corner * row_marks::kFirstEarlier));
      hn::StoreU(hn::Compress(marked, mask), u, entries_.reach + at);
      at += hn::CountTrue(u, mask);
    }
    entries_.count = at;
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(u, hn::And(many, there), bytes);
    return bytes[0] | (Tile::kLanes > 8 ? bytes[1] << 8 : 0);
  }

  static constexpr int kRowAxes = Dim - 1;
  static constexpr std::uint32_t kCorners = 1U << kRowAxes;
  [[nodiscard]] std::uint32_t stride(int axis) const { return cut_.stride[row_axes_[axis]]; }

  const RowCut<Value, Dim>& cut_;
  typename RowSweep<Value, Dim>::Entries& entries_;
  int row_axes_[kRowAxes + 1] = {};
};

/// The members of a row in tiles. Every tile stays in registers, and meets first the earlier members that still reach
/// it, then itself.
template <class Value, int Dim>
class Sweep {
 public:
  Sweep(const RowMember<Value>* members, std::uint32_t count, const std::uint32_t* bins, std::uint32_t first, bool all,
        SweepScratch& scratch, SweepSink& sink)
      : members_(members), count_(count), bins_(bins), before_(first), all_(all ? ~0U : 0U), sink_(sink) {
    const std::size_t tiles = (count + kLanes - 1) / kLanes;
    const std::size_t listed = count + 2 * std::size_t{kMaxLanes};
    const std::size_t hits = std::max<std::size_t>(kHits, 2 * listed);
    const std::size_t tile_bytes = tiles * kTile * sizeof(Value);
    std::byte* const memory =
        scratch.get(tile_bytes + 2 * listed * sizeof(std::uint32_t) + hits * sizeof(SweepHit) + 64);
    tiles_ = reinterpret_cast<Value*>(memory);
    open_ = reinterpret_cast<std::uint32_t*>(memory + tile_bytes);
    until_ = open_ + listed;
    hits_ = reinterpret_cast<SweepHit*>(until_ + listed);
    most_hits_ = hits;
  }

  std::uint64_t run() {
    std::size_t open = 0;
    std::size_t found = 0;
    for (std::uint32_t first = 0; first < count_; first += kLanes) {
      Value* const tile = tiles_ + std::size_t{first / kLanes} * kTile;
      const Value* boxes[kLanes];
      for (std::uint32_t lane = 0; lane < kLanes; ++lane) boxes[lane] = members_[first + lane].box;
      Tile::load(boxes, tile);
      if (found + open + kLanes > most_hits_) flush(found);
      found = meet(tile, first, open, found);
      open = advance(first, open);
    }
    flush(found);
    return meetings_;
  }

 private:
  using Tile = Tiles<Value, Dim>;
  using D = typename Tile::D;
  using V = typename Tile::V;
  static constexpr std::uint32_t kMaxLanes = Tile::kMaxLanes;
  static constexpr std::uint32_t kLanes = Tile::kLanes;
  static constexpr std::size_t kTile = Tile::kTile;
  using Ids = hn::CappedTag<std::uint32_t, kMaxLanes>;
  static constexpr std::uint32_t kIdLanes = hn::MaxLanes(Ids());
  static constexpr std::uint32_t kAll = (1U << kLanes) - 1;
  static constexpr std::size_t kHits = 1024;
  // In a box.
  static constexpr int kMin = 0;
  static constexpr int kMax = Dim;
  static constexpr int kOldMin = 2 * Dim;
  static constexpr int kOldMax = 3 * Dim;

  void flush(std::size_t& found) {
    for (std::size_t i = 0; i < found; ++i) {
      SweepHit& hit = hits_[i];  // in it, the place of a member's first value
      hit.member = static_cast<std::uint32_t>(hit.member / kTile * kLanes + hit.member % kTile);
    }
    if (found > 0) sink_.take({hits_, found});
    found = 0;
  }

  // ---- comparing

  /// One side of the boxes of a tile.
  struct Side {
    V min[Dim];
    V max[Dim];
  };
  template <std::size_t... kAxis>
  static HWY_INLINE Side side(const Value* tile, int from, std::index_sequence<kAxis...>) {
    return {{hn::Load(D(), tile + (from + kAxis) * kLanes)...},
            {hn::Load(D(), tile + (from + Dim + kAxis) * kLanes)...}};
  }

  template <int kAxis>
  static HWY_INLINE auto meets(const Side& side, const Value* query, int from) {
    const auto low = hn::Le(side.min[kAxis], hn::Set(D(), query[(from + Dim + kAxis) * kLanes]));
    const auto high = hn::Ge(side.max[kAxis], hn::Set(D(), query[(from + kAxis) * kLanes]));
    if constexpr (kAxis + 1 < Dim) {
      return hn::And(hn::And(low, high), meets<kAxis + 1>(side, query, from));
    } else {
      return hn::And(low, high);
    }
  }

  static HWY_INLINE std::uint32_t lanes_of(hn::Mask<D> mask) {
    std::uint8_t bytes[8];
    hn::StoreMaskBits(D(), mask, bytes);
    if constexpr (kLanes > 8) {
      std::uint16_t lanes;
      std::memcpy(&lanes, bytes, sizeof(lanes));
      return lanes;
    } else {
      return bytes[0];
    }
  }

  /// The earlier members that are open, and those of the tile, each with those behind it. Returns how many hits there
  /// are then.
  HWY_INLINE std::size_t meet(const Value* tile, std::uint32_t first, std::size_t open, std::size_t found) {
    constexpr auto kAxes = std::make_index_sequence<Dim>();
    const Side now = side(tile, kMin, kAxes);
    const Side before = side(tile, kOldMin, kAxes);
    // Behind the end of the row are members of others.
    const std::uint32_t here = std::min(kLanes, count_ - first);
    const std::uint32_t lanes_here = kAll >> (kLanes - here);
    const auto test = [&](const Value* query, std::uint32_t place, std::uint32_t lanes) HWY_ATTR {
      const std::uint32_t is = lanes_of(meets<0>(now, query, kMin)) & lanes;
      const std::uint32_t was = lanes_of(meets<0>(before, query, kOldMin)) & lanes;
      const std::uint32_t changed = (was ^ is) | (was & is & all_);
      hits_[found] = {place, first, static_cast<std::uint16_t>(changed), static_cast<std::uint16_t>(is)};
      found += changed != 0 ? 1 : 0;
    };
    for (std::size_t i = 0; i < open; ++i) test(tiles_ + open_[i], open_[i], lanes_here);
    const auto place = static_cast<std::uint32_t>(tile - tiles_);
    for (std::uint32_t lane = 0; lane + 1 < here; ++lane) {
      test(tile + lane, place + lane, (kAll << (lane + 1)) & lanes_here);
    }
    return found;
  }

  /// Keeps of the open members, and of those of the tile, the ones that reach beyond it.
  HWY_INLINE std::size_t advance(std::uint32_t first, std::size_t open) {
    const Ids d;
    const auto end = hn::Set(d, first + kLanes);
    std::size_t kept = 0;
    const auto keep = [&](auto places, auto reach, std::size_t count) HWY_ATTR {
      const auto reaching = hn::And(hn::Gt(reach, end), hn::FirstN(d, count));
      // Whole vectors, for there is room: to compress into memory is very slow on some processors.
      hn::StoreU(hn::Compress(places, reaching), d, open_ + kept);
      hn::StoreU(hn::Compress(reach, reaching), d, until_ + kept);
      kept += hn::CountTrue(d, reaching);
    };
    for (std::size_t i = 0; i < open; i += kIdLanes) {
      keep(hn::LoadU(d, open_ + i), hn::LoadU(d, until_ + i), open - i);
    }
    const std::uint32_t place = first / kLanes * static_cast<std::uint32_t>(kTile);
    const std::uint32_t own = std::min(kLanes, count_ - first);
    alignas(64) std::uint32_t reach[std::max(kLanes, kIdLanes)];
    std::uint64_t reached = 0;
    for (std::uint32_t lane = 0; lane < own; ++lane) {
      reach[lane] = bins_[members_[first + lane].reach >> row_marks::kBits] - before_;
      reached += reach[lane];
    }
    meetings_ += reached - (std::uint64_t{first} + 1) * own - own * (own - 1) / 2;
    for (std::uint32_t lane = 0; lane < own; lane += kIdLanes) {
      keep(hn::Iota(d, place + lane), hn::LoadU(d, reach + lane), own - lane);
    }
    return kept;
  }

  const RowMember<Value>* members_;
  std::uint32_t count_;
  const std::uint32_t* bins_;
  std::uint32_t before_;
  std::uint64_t meetings_ = 0;
  std::uint32_t all_;
  SweepSink& sink_;
  Value* tiles_;
  // The open members: the places of their first values, and what they reach.
  std::uint32_t* open_;
  std::uint32_t* until_;
  SweepHit* hits_;
  std::size_t most_hits_;
};

// Highway's tables want functions that are no templates.
#define SWEEPGRID_ROW_SWEEP(VALUE, DIM)                                                                                \
  std::uint64_t sweep_##VALUE##_##DIM(const RowMember<VALUE>* members, std::uint32_t count, const std::uint32_t* bins, \
                                      std::uint32_t first, bool all, SweepScratch& scratch, SweepSink& sink) {         \
    return Sweep<VALUE, DIM>(members, count, bins, first, all, scratch, sink).run();                                   \
  }
SWEEPGRID_ALL_ROW_SWEEPS
#undef SWEEPGRID_ROW_SWEEP
#define SWEEPGRID_ROW_SWEEP(VALUE, DIM)                                                                    \
  std::size_t place_##VALUE##_##DIM(const VALUE** boxes, std::uint32_t* objects, std::uint32_t count,      \
                                    const RowCut<VALUE, DIM>& cut, RowSweep<VALUE, DIM>::Entries& entries, \
                                    std::uint32_t* far) {                                                  \
    return Placing<VALUE, DIM>(cut, entries).run(boxes, objects, count, far);                              \
  }
SWEEPGRID_ALL_ROW_SWEEPS
#undef SWEEPGRID_ROW_SWEEP

}  // namespace sweepgrid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sweepgrid {

#define SWEEPGRID_ROW_SWEEP(VALUE, DIM)                                                                              \
  HWY_EXPORT(sweep_##VALUE##_##DIM);                                                                                 \
  template <>                                                                                                        \
  std::uint64_t RowSweep<VALUE, DIM>::sweep(const Member* members, std::uint32_t count, const std::uint32_t* bins,   \
                                            std::uint32_t first, bool all, SweepScratch& scratch, SweepSink& sink) { \
    return HWY_DYNAMIC_DISPATCH(sweep_##VALUE##_##DIM)(members, count, bins, first, all, scratch, sink);             \
  }                                                                                                                  \
  HWY_EXPORT(place_##VALUE##_##DIM);                                                                                 \
  template <>                                                                                                        \
  std::size_t RowSweep<VALUE, DIM>::place(const VALUE** boxes, std::uint32_t* objects, std::uint32_t count,          \
                                          const Cut& cut, Entries& entries, std::uint32_t* far) {                    \
    return HWY_DYNAMIC_DISPATCH(place_##VALUE##_##DIM)(boxes, objects, count, cut, entries, far);                    \
  }
SWEEPGRID_ALL_ROW_SWEEPS
#undef SWEEPGRID_ROW_SWEEP

}  // namespace sweepgrid
#endif  // HWY_ONCE
