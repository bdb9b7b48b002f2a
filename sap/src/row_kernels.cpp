// Compiled several times over, once for each instruction set: foreach_target.h includes this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "row_kernels.cpp"  // NOLINT(bugprone-suspicious-include): that is how Highway works
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <stdexcept>

#include <sweepgrid/sap/row_kernels.hpp>

#ifndef SWEEPGRID_ROW_KERNELS_ONCE
#define SWEEPGRID_ROW_KERNELS_ONCE
namespace sweepgrid {

/// The places of a drain's ops. On the stack unless they are many.
class Places {
 public:
  explicit Places(std::size_t ops) {
    if (ops > few_.size()) many_ = std::make_unique_for_overwrite<std::uint32_t[]>(ops);
    data_ = many_ ? many_.get() : few_.data();
  }
  std::uint32_t& operator[](std::size_t op) { return data_[op]; }

 private:
  std::array<std::uint32_t, 256> few_;
  std::unique_ptr<std::uint32_t[]> many_;
  std::uint32_t* data_;
};

/// How many ops of each kind a drain has.
struct Tally {
  std::uint32_t updates = 0;
  std::uint32_t inserts = 0;
  std::uint32_t erases = 0;
};

/// The number of pairs among `count` objects.
inline std::uint64_t pairs(std::uint64_t count) { return count * (count - (count != 0 ? 1 : 0)) / 2; }

/// Calls SWEEPGRID_ROW_KERNELS for every width and number of axes that kernels are compiled for.
#define SWEEPGRID_ALL_ROW_KERNELS                                                                                     \
  SWEEPGRID_ROW_KERNELS(32, 1)                                                                                        \
  SWEEPGRID_ROW_KERNELS(32, 2) SWEEPGRID_ROW_KERNELS(32, 3) SWEEPGRID_ROW_KERNELS(32, 4) SWEEPGRID_ROW_KERNELS(64, 1) \
      SWEEPGRID_ROW_KERNELS(64, 2) SWEEPGRID_ROW_KERNELS(64, 3) SWEEPGRID_ROW_KERNELS(64, 4)

}  // namespace sweepgrid
#endif  // SWEEPGRID_ROW_KERNELS_ONCE

HWY_BEFORE_NAMESPACE();
namespace sweepgrid::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// A set of lanes, one bit each.
using Lanes = std::uint32_t;
constexpr std::uint32_t kMaxLanes = 16;

/// The lanes of a block of rows that begins at place `first` whose places are below `end`.
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

/// Appends a delta for every lane in `changed`: +1 if it is in `is`, otherwise -1.
HWY_INLINE void report(ObjectId object, const ObjectId* others, Lanes changed, Lanes is,
                       std::vector<OverlapDelta>& deltas) {
  for (; changed != 0; changed &= changed - 1) {
    const int lane = std::countr_zero(changed);
    deltas.push_back({PairKey(object, others[lane]), (is >> lane & 1) != 0 ? +1 : -1});
  }
}

template <class Bits, int Dim>
struct Kernels {
  using Block = RowBlock<Bits, Dim>;
  using Ops = OpViews<Bits, Dim>;
  using Visits = VisitViews<Bits, Dim>;
  using Value = typename Block::Value;
  using D = hn::CappedTag<Value, kMaxLanes>;
  using V = hn::Vec<D>;
  using IdTag = hn::CappedTag<ObjectId, kMaxLanes>;
  static constexpr std::uint32_t kLanes = hn::MaxLanes(D());
  static constexpr Lanes kAll = (Lanes{1} << kLanes) - 1;
  static constexpr std::uint32_t kIdLanes = hn::MaxLanes(IdTag());
  static constexpr int kRows = Block::kValueRows;
  static constexpr std::uint32_t kAbsent = 0xffffffffU;

  /// One vector for each row of values: the boxes of neighbouring places, or one box in every lane.
  struct Boxes {
    V rows[kRows];
  };

  static HWY_INLINE Boxes load(const Block& block, std::uint32_t first) {
    Boxes boxes;
    for (int row = 0; row < kRows; ++row) boxes.rows[row] = hn::LoadU(D(), block.row(row) + first);
    return boxes;
  }

  static HWY_INLINE Boxes everywhere(const Block& block, std::uint32_t place) {
    Boxes boxes;
    for (int row = 0; row < kRows; ++row) boxes.rows[row] = hn::Set(D(), block.row(row)[place]);
    return boxes;
  }

  static HWY_INLINE Boxes everywhere(const Bits* box) {
    const V flip = hn::Set(D(), static_cast<Value>(Block::kFlip));
    Boxes boxes;
    for (int row = 0; row < kRows; ++row) {
      boxes.rows[row] = hn::Xor(hn::Set(D(), static_cast<Value>(box[row])), flip);
    }
    return boxes;
  }

  static HWY_INLINE Lanes overlaps(const Boxes& a, const Boxes& b) {
    auto apart = hn::Or(hn::Gt(a.rows[0], b.rows[Dim]), hn::Gt(b.rows[0], a.rows[Dim]));
    for (int axis = 1; axis < Dim; ++axis) {
      apart = hn::Or(apart, hn::Or(hn::Gt(a.rows[axis], b.rows[Dim + axis]), hn::Gt(b.rows[axis], a.rows[Dim + axis])));
    }
    return ~lanes_of(D(), apart) & kAll;
  }

  /// The place of an object, or kAbsent.
  static HWY_INLINE std::uint32_t find(const Block& block, ObjectId object) {
    const auto wanted = hn::Set(IdTag(), object);
    const std::uint32_t size = block.size();
    for (std::uint32_t first = 0; first < size; first += kIdLanes) {
      const Lanes found =
          lanes_of(IdTag(), hn::Eq(hn::LoadU(IdTag(), block.ids() + first), wanted)) & lanes_below(first, size);
      if (found != 0) return first + static_cast<std::uint32_t>(std::countr_zero(found));
    }
    return kAbsent;
  }

  /// Looks every object up. Returns the index of an op that is to be refused, or the number of ops.
  static HWY_INLINE std::size_t resolve(const Block& block, Ops ops, Places& places, Tally& tally) {
    for (std::size_t index = 0; index < ops.size(); ++index) {
      const auto op = ops[index];
      places[index] = find(block, op.object());
      if ((places[index] == kAbsent) != (op.kind() == OpKind::kInsert)) return index;
      tally.inserts += op.kind() == OpKind::kInsert ? 1 : 0;
      tally.erases += op.kind() == OpKind::kErase ? 1 : 0;
    }
    tally.updates = static_cast<std::uint32_t>(ops.size()) - tally.inserts - tally.erases;
    return ops.size();
  }

  /// Reports the pairs that cease with the erased objects, each once.
  static void part(const Block& block, Ops ops, Places& places, std::vector<OverlapDelta>& deltas) {
    for (std::uint32_t first = 0; first < block.size(); first += kLanes) {
      const Boxes boxes = load(block, first);
      Lanes open = lanes_below(first, block.size());
      for (std::size_t index = 0; index < ops.size(); ++index) {
        const auto op = ops[index];
        if (op.kind() != OpKind::kErase) continue;
        open &= ~(lanes_below(first, places[index] + 1) ^ lanes_below(first, places[index]));
        const Lanes ends = overlaps(everywhere(block, places[index]), boxes) & open;
        report(op.object(), block.ids() + first, ends, 0, deltas);
      }
    }
  }

  static void remove(Block& block, Ops ops, Places& places) {
    for (std::size_t index = 0; index < ops.size(); ++index) {
      if (ops[index].kind() != OpKind::kErase) continue;
      block.remove(places[index]);
      // The last object moved there.
      for (std::size_t other = 0; other < ops.size(); ++other) {
        if (places[other] == block.size()) places[other] = places[index];
      }
    }
  }

  /// Gives the inserted objects places; their values are yet to be written.
  static HWY_INLINE void append(Block& block, Ops ops, Places& places) {
    for (std::size_t index = 0; index < ops.size(); ++index) {
      const auto op = ops[index];
      if (op.kind() == OpKind::kInsert) places[index] = block.append(op.object());
    }
  }

  static HWY_INLINE void write(Block& block, Ops ops, Places& places) {
    for (std::size_t index = 0; index < ops.size(); ++index) {
      const auto op = ops[index];
      if (op.kind() == OpKind::kErase) continue;
      for (int row = 0; row < kRows; ++row) block.set_bits(row, places[index], op.box()[row]);
    }
  }

  /// Reports how pairs change with the updated and inserted objects, each once, and writes the new boxes. `known`: the
  /// number of objects that have boxes; the inserted ones follow.
  static HWY_INLINE void change(Block& block, std::uint32_t known, Ops ops, Places& places,
                                std::vector<OverlapDelta>& deltas) {
    for (std::uint32_t first = 0; first < block.size(); first += kLanes) {
      const Boxes old_boxes = load(block, first);
      Boxes new_boxes = old_boxes;
      for (std::size_t index = 0; index < ops.size(); ++index) {
        const auto op = ops[index];
        const std::uint32_t lane = places[index] - first;
        if (lane >= kLanes || op.kind() == OpKind::kErase) continue;
        const auto own = hn::Eq(hn::Iota(D(), 0), hn::Set(D(), static_cast<Value>(lane)));
        const Boxes box = everywhere(op.box());
        for (int row = 0; row < kRows; ++row) {
          new_boxes.rows[row] = hn::IfThenElse(own, box.rows[row], new_boxes.rows[row]);
        }
      }
      const Lanes had_box = lanes_below(first, known);
      const Lanes has_box = lanes_below(first, block.size());
      Lanes open = ~Lanes{0};
      for (std::size_t index = 0; index < ops.size(); ++index) {
        const auto op = ops[index];
        if (op.kind() == OpKind::kErase) continue;
        const std::uint32_t lane = places[index] - first;
        open &= ~(lane < kLanes ? Lanes{1} << lane : 0);
        const Lanes was = places[index] >= known ? 0 : overlaps(everywhere(block, places[index]), old_boxes) & had_box;
        const Lanes is = overlaps(everywhere(op.box()), new_boxes) & has_box;
        report(op.object(), block.ids() + first, (was ^ is) & open, is, deltas);
      }
      if (block.size() <= kLanes) {
        // In this order: each row's vector spills over into the next row.
        for (int row = 0; row < kRows; ++row) hn::StoreU(new_boxes.rows[row], D(), block.row(row));
        return;
      }
    }
    write(block, ops, places);
  }

  static std::size_t drain(Block& block, Ops ops, std::vector<OverlapDelta>& deltas, SapCounters& counters) {
    Places places(ops.size());
    Tally tally;
    const std::size_t refused = resolve(block, ops, places, tally);
    if (refused != ops.size()) return refused;
    block.reserve(block.size() - tally.erases + tally.inserts);
    const std::size_t deltas_before = deltas.size();
    const std::uint32_t old_size = block.size();
    if (tally.erases != 0) {
      part(block, ops, places, deltas);
      remove(block, ops, places);
    }
    const std::uint32_t known = block.size();
    if (tally.inserts != 0) append(block, ops, places);
    if (tally.inserts + tally.updates != 0) change(block, known, ops, places, deltas);
    block.fit();
    counters.deltas += deltas.size() - deltas_before;
    counters.box_tests +=
        pairs(old_size) - pairs(known - tally.updates) + pairs(block.size()) - pairs(known - tally.updates);
    return ops.size();
  }

  static std::size_t transfer(Block& block, Ops ops) {
    Places places(ops.size());
    Tally tally;
    const std::size_t refused = resolve(block, ops, places, tally);
    if (refused != ops.size()) return refused;
    block.reserve(block.size() - tally.erases + tally.inserts);
    if (tally.erases != 0) remove(block, ops, places);
    append(block, ops, places);
    write(block, ops, places);
    block.fit();
    return ops.size();
  }

  static void visit(const Block& block, Visits visits, std::vector<OverlapDelta>& deltas, SapCounters& counters) {
    const std::size_t deltas_before = deltas.size();
    std::uint64_t boxes_compared = 0;
    for (std::size_t index = 0; index < visits.size(); ++index) {
      const auto visit = visits[index];
      const Lanes if_was = visit.was() ? ~Lanes{0} : 0;
      const Lanes if_is = visit.is() ? ~Lanes{0} : 0;
      const Boxes before = everywhere(visit.before());
      const Boxes after = everywhere(visit.after());
      boxes_compared += (if_was & 1) + (if_is & 1);
      for (std::uint32_t first = 0; first < block.size(); first += kLanes) {
        const Boxes boxes = load(block, first);
        const Lanes was = overlaps(before, boxes) & if_was;
        const Lanes is = overlaps(after, boxes) & if_is;
        report(visit.object(), block.ids() + first, (was ^ is) & lanes_below(first, block.size()), is, deltas);
      }
    }
    counters.deltas += deltas.size() - deltas_before;
    counters.box_tests += boxes_compared * block.size();
  }
};

// Highway's tables want functions that are no templates.
#define SWEEPGRID_ROW_KERNELS(WIDTH, DIM)                                                                      \
  std::size_t drain_##WIDTH##_##DIM(RowBlock<std::uint##WIDTH##_t, DIM>& block,                                \
                                    OpViews<std::uint##WIDTH##_t, DIM> ops, std::vector<OverlapDelta>& deltas, \
                                    SapCounters& counters) {                                                   \
    return Kernels<std::uint##WIDTH##_t, DIM>::drain(block, ops, deltas, counters);                            \
  }                                                                                                            \
  std::size_t transfer_##WIDTH##_##DIM(RowBlock<std::uint##WIDTH##_t, DIM>& block,                             \
                                       OpViews<std::uint##WIDTH##_t, DIM> ops) {                               \
    return Kernels<std::uint##WIDTH##_t, DIM>::transfer(block, ops);                                           \
  }                                                                                                            \
  void visit_##WIDTH##_##DIM(const RowBlock<std::uint##WIDTH##_t, DIM>& block,                                 \
                             VisitViews<std::uint##WIDTH##_t, DIM> visits, std::vector<OverlapDelta>& deltas,  \
                             SapCounters& counters) {                                                          \
    Kernels<std::uint##WIDTH##_t, DIM>::visit(block, visits, deltas, counters);                                \
  }
SWEEPGRID_ALL_ROW_KERNELS
#undef SWEEPGRID_ROW_KERNELS

}  // namespace sweepgrid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sweepgrid {

#define SWEEPGRID_ROW_KERNELS(WIDTH, DIM)                                                                            \
  HWY_EXPORT(drain_##WIDTH##_##DIM);                                                                                 \
  HWY_EXPORT(transfer_##WIDTH##_##DIM);                                                                              \
  HWY_EXPORT(visit_##WIDTH##_##DIM);                                                                                 \
  template <>                                                                                                        \
  std::size_t RowKernels<std::uint##WIDTH##_t, DIM>::drain(Block& block, Ops ops, std::vector<OverlapDelta>& deltas, \
                                                           SapCounters& counters) {                                  \
    return HWY_DYNAMIC_DISPATCH(drain_##WIDTH##_##DIM)(block, ops, deltas, counters);                                \
  }                                                                                                                  \
  template <>                                                                                                        \
  std::size_t RowKernels<std::uint##WIDTH##_t, DIM>::transfer(Block& block, Ops ops) {                               \
    return HWY_DYNAMIC_DISPATCH(transfer_##WIDTH##_##DIM)(block, ops);                                               \
  }                                                                                                                  \
  template <>                                                                                                        \
  void RowKernels<std::uint##WIDTH##_t, DIM>::visit(const Block& block, Visits visits,                               \
                                                    std::vector<OverlapDelta>& deltas, SapCounters& counters) {      \
    HWY_DYNAMIC_DISPATCH(visit_##WIDTH##_##DIM)(block, visits, deltas, counters);                                    \
  }
SWEEPGRID_ALL_ROW_KERNELS
#undef SWEEPGRID_ROW_KERNELS

std::vector<std::string> row_kernel_targets() {
  std::vector<std::string> names;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) names.emplace_back(hwy::TargetName(target));
  return names;
}

void use_row_kernel_target(const std::string& target) {
  hwy::SetSupportedTargetsForTest(0);
  for (const std::int64_t candidate : hwy::SupportedAndGeneratedTargets()) {
    if (target == hwy::TargetName(candidate)) hwy::SetSupportedTargetsForTest(candidate);
  }
  const bool found = target.empty() || row_kernel_targets() == std::vector<std::string>{target};
  if (!found) throw std::invalid_argument("sweepgrid: this machine has no row kernels for " + target);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace sweepgrid
#endif  // HWY_ONCE
