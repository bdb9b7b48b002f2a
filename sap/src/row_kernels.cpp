// Compiled several times over, once for each instruction set: foreach_target.h includes this file again and again.

// Vectors whose size is not known to the compiler can be no members of a class, as Boxes has them; on such machines the
// kernels are those of NEON. Which processor has which is chosen at run time everywhere else.
#if defined(__aarch64__) && !defined(HWY_DISABLED_TARGETS)
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "row_kernels.cpp"  // NOLINT(bugprone-suspicious-include): that is how Highway works
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory_resource>
#include <span>
#include <stdexcept>

#include <sweepgrid/sap/row_kernels.hpp>

#include "row_boxes-inl.hpp"

#ifndef SWEEPGRID_ROW_KERNELS_ONCE
#define SWEEPGRID_ROW_KERNELS_ONCE
namespace sweepgrid {

/// What one op changes among neighbouring places, at most 16: a bit for each pair that does, and above them one for
/// each that overlaps now.
using Hits = std::uint32_t;

/// For each op of a drain its object's place and what it hits. On the stack unless they are many.
class Scratch {
 public:
  Scratch(std::size_t ops, std::pmr::memory_resource* memory) : entries_(few_) {
    if (ops > kFew) [[unlikely]]
      entries_ = static_cast<Entry*>(memory->allocate(ops * sizeof(Entry), alignof(Entry)));
  }
  std::uint32_t& place(std::size_t op) { return entries_[op].place; }
  Hits& hits(std::size_t op) { return entries_[op].hits; }

 private:
  struct Entry {
    std::uint32_t place;
    Hits hits;
  };
  static constexpr std::size_t kFew = 256;
  Entry few_[kFew];  // not initialised on purpose
  Entry* entries_;
};

/// Scratch in the memory that the list of deltas lends.
class LentScratch : public Scratch {
 public:
  LentScratch(std::size_t ops, DeltaList& deltas) : Scratch(ops, &deltas.scratch()), memory_(deltas.scratch()) {}
  ~LentScratch() { memory_.reset(); }
  LentScratch(const LentScratch&) = delete;
  LentScratch& operator=(const LentScratch&) = delete;

 private:
  ScratchMemory& memory_;
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
#define SWEEPGRID_ALL_ROW_KERNELS \
  SWEEPGRID_ROW_KERNELS(32, 1)    \
  SWEEPGRID_ROW_KERNELS(32, 2)    \
  SWEEPGRID_ROW_KERNELS(32, 3)    \
  SWEEPGRID_ROW_KERNELS(32, 4)    \
  SWEEPGRID_ROW_KERNELS(64, 1) SWEEPGRID_ROW_KERNELS(64, 2) SWEEPGRID_ROW_KERNELS(64, 3) SWEEPGRID_ROW_KERNELS(64, 4)

}  // namespace sweepgrid
#endif  // SWEEPGRID_ROW_KERNELS_ONCE

HWY_BEFORE_NAMESPACE();
namespace sweepgrid::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Appends a delta for every pair that an object changes.
HWY_NOINLINE void report(ObjectId object, const ObjectId* others, Hits hits, DeltaList& deltas) {
  for (Lanes changed = hits & 0xffff; changed != 0; changed &= changed - 1) {
    const int lane = std::countr_zero(changed);
    deltas.push_back({PairKey(object, others[lane]), (hits >> (16 + lane) & 1) != 0 ? +1 : -1});
  }
}

/// Reports what ops or visits change. In a loop of its own, because a call between vector operations would force their
/// registers into memory.
template <class Views>
HWY_INLINE void report(Scratch& scratch, Views views, const ObjectId* others, DeltaList& deltas) {
  for (std::size_t index = 0; index < views.size(); ++index) {
    const Hits hits = scratch.hits(index);
    if ((hits & 0xffff) != 0) report(views[index].object(), others, hits, deltas);
  }
}

template <class Bits, int Dim>
struct Kernels {
  using Block = RowBlock<Bits, Dim>;
  using Ops = OpViews<Bits, Dim>;
  using Visits = VisitViews<Bits, Dim>;
  using Box = Boxes<Bits, Dim>;
  using IdTag = hn::CappedTag<ObjectId, kMaxLanes>;
  static constexpr std::uint32_t kLanes = Box::kLanes;
  static constexpr std::uint32_t kIdLanes = hn::MaxLanes(IdTag());
  static constexpr std::uint32_t kAbsent = 0xffffffffU;

  /// The places in `first` and the next that hold an object, one bit each.
  static HWY_INLINE Lanes places_of(const Block& block, ObjectId object, std::uint32_t first) {
    return lanes_of(IdTag(), hn::Eq(hn::LoadU(IdTag(), block.ids() + first), hn::Set(IdTag(), object)));
  }

  /// The place of an object, or kAbsent.
  static HWY_INLINE std::uint32_t find(const Block& block, ObjectId object) {
    const std::uint32_t size = block.size();
    if (size == 0) return kAbsent;
    if (size <= kIdLanes) {
      const Lanes found = places_of(block, object, 0) & lanes_below(0, size);
      return found != 0 ? static_cast<std::uint32_t>(std::countr_zero(found)) : kAbsent;
    }
    // Four vectors to a branch, because the branch that ends the search cannot be foretold. The rows of values behind
    // the ids are long enough to be read in place of missing ids.
    for (std::uint32_t first = 0; first < size; first += 4 * kIdLanes) {
      std::uint64_t found = 0;
      for (std::uint32_t part = 0; part < 4; ++part) {
        found |= std::uint64_t{places_of(block, object, first + part * kIdLanes)} << (part * kIdLanes);
      }
      if (size - first < 64) found &= (std::uint64_t{1} << (size - first)) - 1;
      if (found != 0) return first + static_cast<std::uint32_t>(std::countr_zero(found));
    }
    return kAbsent;
  }

  /// Looks every object up. Returns the index of an op that is to be refused, or the number of ops.
  static HWY_INLINE std::size_t resolve(const Block& block, Ops ops, Scratch& scratch, Tally& tally) {
    for (std::size_t index = 0; index < ops.size(); ++index) {
      const auto op = ops[index];
      scratch.place(index) = find(block, op.object());
      if ((scratch.place(index) == kAbsent) != (op.kind() == OpKind::kInsert)) return index;
      tally.inserts += op.kind() == OpKind::kInsert ? 1 : 0;
      tally.erases += op.kind() == OpKind::kErase ? 1 : 0;
    }
    tally.updates = static_cast<std::uint32_t>(ops.size()) - tally.inserts - tally.erases;
    return ops.size();
  }

  /// Reports the pairs that cease with the erased objects, each once.
  static HWY_NOINLINE void part(const Block& block, Ops ops, Scratch& scratch, DeltaList& deltas) {
    for (std::uint32_t first = 0; first < block.size(); first += kLanes) {
      const Box boxes = Box::load(block, first);
      Lanes open = lanes_below(first, block.size());
      for (std::size_t index = 0; index < ops.size(); ++index) {
        const auto op = ops[index];
        scratch.hits(index) = 0;
        if (op.kind() != OpKind::kErase) continue;
        const std::uint32_t lane = scratch.place(index) - first;
        open &= ~(Lanes{lane < kLanes} << (lane % 32));
        scratch.hits(index) = boxes.overlaps(Box::at(block, scratch.place(index))) & open;
      }
      report(scratch, ops, block.ids() + first, deltas);
    }
  }

  static HWY_NOINLINE void remove(Block& block, Ops ops, Scratch& scratch) {
    for (std::size_t index = 0; index < ops.size(); ++index) {
      if (ops[index].kind() != OpKind::kErase) continue;
      block.remove(scratch.place(index));
      // The last object moved there.
      for (std::size_t other = 0; other < ops.size(); ++other) {
        if (scratch.place(other) == block.size()) scratch.place(other) = scratch.place(index);
      }
    }
  }

  /// Gives the inserted objects places; their values are yet to be written.
  static HWY_INLINE void append(Block& block, Ops ops, Scratch& scratch) {
    for (std::size_t index = 0; index < ops.size(); ++index) {
      const auto op = ops[index];
      if (op.kind() == OpKind::kInsert) scratch.place(index) = block.append(op.object());
    }
  }

  static HWY_INLINE void write(Block& block, Ops ops, Scratch& scratch) {
    for (std::size_t index = 0; index < ops.size(); ++index) {
      const auto op = ops[index];
      if (op.kind() == OpKind::kErase) continue;
      for (int row = 0; row < Block::kValueRows; ++row) block.set_bits(row, scratch.place(index), op.box()[row]);
    }
  }

  /// Reports how pairs change with the updated and inserted objects, each once, and writes the new boxes. `known`: the
  /// number of objects that have boxes; the inserted ones follow.
  static HWY_INLINE void change(Block& block, std::uint32_t known, Ops ops, Scratch& scratch, DeltaList& deltas) {
    if (block.size() <= kLanes) {
      change_lanes<true>(block, 0, known, ops, scratch, deltas);
      return;
    }
    for (std::uint32_t first = 0; first < block.size(); first += kLanes) {
      change_lanes<false>(block, first, known, ops, scratch, deltas);
    }
    write(block, ops, scratch);
  }

  template <bool kAlone>
  static HWY_INLINE void change_lanes(Block& block, std::uint32_t first, std::uint32_t known, Ops ops, Scratch& scratch,
                                      DeltaList& deltas) {
    const Box old_boxes = Box::load(block, first);
    Box new_boxes = old_boxes;
    for (std::size_t index = 0; index < ops.size(); ++index) {
      const auto op = ops[index];
      if (op.kind() == OpKind::kErase) continue;
      // No branch for a place elsewhere: it could not be foretold, and there is no such lane.
      new_boxes.set(scratch.place(index) - first, Box::everywhere(op.box()));
    }
    const Lanes had_box = lanes_below(first, known);
    const Lanes has_box = lanes_below(first, block.size());
    Lanes open = Box::kAll;
    for (std::size_t index = 0; index < ops.size(); ++index) {
      const auto op = ops[index];
      if (op.kind() == OpKind::kErase) {
        scratch.hits(index) = 0;
        continue;
      }
      const std::uint32_t place = scratch.place(index);
      const std::uint32_t lane = place - first;
      open &= ~(Lanes{kAlone || lane < kLanes} << (lane % 32));
      const Lanes was = old_boxes.overlaps(Box::at(block, place)) & (place < known ? had_box : 0);
      const Lanes is = new_boxes.overlaps(Box::everywhere(op.box())) & has_box;
      scratch.hits(index) = ((was ^ is) & open) | is << 16;
    }
    if constexpr (kAlone) {
      new_boxes.store(block, first);
    }
    report(scratch, ops, block.ids() + first, deltas);
  }

  static std::size_t drain(Block& block, Ops ops, DeltaList& deltas, SapCounters& counters) {
    LentScratch scratch(ops.size(), deltas);
    Tally tally;
    const std::size_t refused = resolve(block, ops, scratch, tally);
    if (refused != ops.size()) return refused;
    block.reserve(std::uint64_t{block.size()} - tally.erases + tally.inserts);
    const std::size_t deltas_before = deltas.size();
    const std::uint32_t old_size = block.size();
    if (tally.erases != 0) {
      part(block, ops, scratch, deltas);
      remove(block, ops, scratch);
    }
    const std::uint32_t known = block.size();
    if (tally.inserts != 0) append(block, ops, scratch);
    if (tally.inserts + tally.updates != 0) change(block, known, ops, scratch, deltas);
    block.fit();
    counters.deltas += deltas.size() - deltas_before;
    counters.box_tests +=
        pairs(old_size) - pairs(known - tally.updates) + pairs(block.size()) - pairs(known - tally.updates);
    return ops.size();
  }

  /// The boxes at `first` and the next places as refresh() has them.
  static HWY_INLINE Box arriving(const Block& block, const Bits* boxes, std::uint32_t first) {
    Box arriving = Box::load(block, first);
    const std::uint32_t count = std::min(block.size() - first, kLanes);
    for (std::uint32_t lane = 0; lane < count; ++lane) {
      arriving.set(lane, Box::everywhere(boxes + std::size_t{first + lane} * (2 * Dim)));
    }
    return arriving;
  }

  static void refresh(Block& block, const Bits* boxes, std::span<const std::uint32_t> moved, DeltaList& deltas,
                      SapCounters& counters) {
    LentScratch scratch(moved.size(), deltas);
    const std::size_t deltas_before = deltas.size();
    for (std::uint32_t first = 0; first < block.size(); first += kLanes) {
      const Box old_boxes = Box::load(block, first);
      const Box new_boxes = arriving(block, boxes, first);
      Lanes open = lanes_below(first, block.size()) & Box::kAll;
      std::size_t compared = 0;
      for (; compared < moved.size() && open != 0; ++compared) {
        const std::uint32_t place = moved[compared];
        const std::uint32_t lane = place - first;
        open &= ~(Lanes{lane < kLanes} << (lane % 32));
        const Lanes was = old_boxes.overlaps(Box::at(block, place));
        const Lanes is = new_boxes.overlaps(Box::everywhere(boxes + std::size_t{place} * (2 * Dim)));
        scratch.hits(compared) = ((was ^ is) & open) | is << 16;
      }
      if (block.size() <= kLanes) new_boxes.store(block, 0);
      for (std::size_t index = 0; index < compared; ++index) {
        const Hits hits = scratch.hits(index);
        if ((hits & 0xffff) != 0) report(block.ids()[moved[index]], block.ids() + first, hits, deltas);
      }
    }
    // From the last places to the first, because a vector may write beyond the end of its row.
    for (std::uint32_t first = (block.size() - 1) / kLanes * kLanes; block.size() > kLanes; first -= kLanes) {
      arriving(block, boxes, first).store(block, first);
      if (first == 0) break;
    }
    counters.deltas += deltas.size() - deltas_before;
    counters.box_tests += 2 * (pairs(block.size()) - pairs(block.size() - moved.size()));
  }

  static std::size_t transfer(Block& block, Ops ops) {
    std::pmr::monotonic_buffer_resource heap;
    Scratch scratch(ops.size(), &heap);
    Tally tally;
    const std::size_t refused = resolve(block, ops, scratch, tally);
    if (refused != ops.size()) return refused;
    block.reserve(std::uint64_t{block.size()} - tally.erases + tally.inserts);
    if (tally.erases != 0) remove(block, ops, scratch);
    append(block, ops, scratch);
    write(block, ops, scratch);
    block.fit();
    return ops.size();
  }

  static void visit(const Block& block, const Bits* boxes, Visits visits, DeltaList& deltas, SapCounters& counters) {
    LentScratch scratch(visits.size(), deltas);
    const std::size_t deltas_before = deltas.size();
    for (std::uint32_t first = 0; first < block.size(); first += kLanes) {
      const Box old_boxes = Box::load(block, first);
      const Box new_boxes = boxes == nullptr ? old_boxes : arriving(block, boxes, first);
      const Lanes has_box = lanes_below(first, block.size());
      for (std::size_t index = 0; index < visits.size(); ++index) {
        const auto visit = visits[index];
        const Lanes was = old_boxes.overlaps(Box::everywhere(visit.before())) & (visit.was() ? has_box : 0);
        const Lanes is = new_boxes.overlaps(Box::everywhere(visit.after())) & (visit.is() ? has_box : 0);
        scratch.hits(index) = (was ^ is) | is << 16;
      }
      report(scratch, visits, block.ids() + first, deltas);
    }
    std::uint64_t boxes_compared = 0;
    for (std::size_t index = 0; index < visits.size(); ++index) {
      boxes_compared += (visits[index].was() ? 1 : 0) + (visits[index].is() ? 1 : 0);
    }
    counters.deltas += deltas.size() - deltas_before;
    counters.box_tests += boxes_compared * block.size();
  }
};

// Highway's tables want functions that are no templates.
#define SWEEPGRID_ROW_KERNELS(WIDTH, DIM)                                                                              \
  std::size_t drain_##WIDTH##_##DIM(RowBlock<std::uint##WIDTH##_t, DIM>& block,                                        \
                                    OpViews<std::uint##WIDTH##_t, DIM> ops, DeltaList& deltas,                         \
                                    SapCounters& counters) {                                                           \
    return Kernels<std::uint##WIDTH##_t, DIM>::drain(block, ops, deltas, counters);                                    \
  }                                                                                                                    \
  std::size_t transfer_##WIDTH##_##DIM(RowBlock<std::uint##WIDTH##_t, DIM>& block,                                     \
                                       OpViews<std::uint##WIDTH##_t, DIM> ops) {                                       \
    return Kernels<std::uint##WIDTH##_t, DIM>::transfer(block, ops);                                                   \
  }                                                                                                                    \
  void refresh_##WIDTH##_##DIM(RowBlock<std::uint##WIDTH##_t, DIM>& block, const std::uint##WIDTH##_t* boxes,          \
                               std::span<const std::uint32_t> moved, DeltaList& deltas, SapCounters& counters) {       \
    Kernels<std::uint##WIDTH##_t, DIM>::refresh(block, boxes, moved, deltas, counters);                                \
  }                                                                                                                    \
  void visit_##WIDTH##_##DIM(const RowBlock<std::uint##WIDTH##_t, DIM>& block, const std::uint##WIDTH##_t* boxes,      \
                             VisitViews<std::uint##WIDTH##_t, DIM> visits, DeltaList& deltas, SapCounters& counters) { \
    Kernels<std::uint##WIDTH##_t, DIM>::visit(block, boxes, visits, deltas, counters);                                 \
  }
SWEEPGRID_ALL_ROW_KERNELS
#undef SWEEPGRID_ROW_KERNELS

}  // namespace sweepgrid::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sweepgrid {

#define SWEEPGRID_ROW_KERNELS(WIDTH, DIM)                                                                      \
  HWY_EXPORT(drain_##WIDTH##_##DIM);                                                                           \
  HWY_EXPORT(transfer_##WIDTH##_##DIM);                                                                        \
  HWY_EXPORT(refresh_##WIDTH##_##DIM);                                                                         \
  HWY_EXPORT(visit_##WIDTH##_##DIM);                                                                           \
  template <>                                                                                                  \
  std::size_t RowKernels<std::uint##WIDTH##_t, DIM>::drain(Block& block, Ops ops, DeltaList& deltas,           \
                                                           SapCounters& counters) {                            \
    return HWY_DYNAMIC_DISPATCH(drain_##WIDTH##_##DIM)(block, ops, deltas, counters);                          \
  }                                                                                                            \
  template <>                                                                                                  \
  std::size_t RowKernels<std::uint##WIDTH##_t, DIM>::transfer(Block& block, Ops ops) {                         \
    return HWY_DYNAMIC_DISPATCH(transfer_##WIDTH##_##DIM)(block, ops);                                         \
  }                                                                                                            \
  template <>                                                                                                  \
  void RowKernels<std::uint##WIDTH##_t, DIM>::refresh(Block& block, const std::uint##WIDTH##_t* boxes,         \
                                                      std::span<const std::uint32_t> moved, DeltaList& deltas, \
                                                      SapCounters& counters) {                                 \
    HWY_DYNAMIC_DISPATCH(refresh_##WIDTH##_##DIM)(block, boxes, moved, deltas, counters);                      \
  }                                                                                                            \
  template <>                                                                                                  \
  void RowKernels<std::uint##WIDTH##_t, DIM>::visit(const Block& block, const std::uint##WIDTH##_t* boxes,     \
                                                    Visits visits, DeltaList& deltas, SapCounters& counters) { \
    HWY_DYNAMIC_DISPATCH(visit_##WIDTH##_##DIM)(block, boxes, visits, deltas, counters);                       \
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
