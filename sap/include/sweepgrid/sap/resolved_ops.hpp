#pragma once

#include <array>
#include <cstddef>
#include <memory_resource>
#include <span>
#include <vector>

#include <sweepgrid/sap/cell_op.hpp>
#include <sweepgrid/sap/delta_list.hpp>
#include <sweepgrid/sap/object_slots.hpp>
#include <sweepgrid/sap/refused_op.hpp>

namespace sweepgrid {

/// Memory for one drain: a buffer on the stack, and beyond that the scratch memory of the list that it writes to.
class DrainArena {
 public:
  /// Beyond the buffer, the heap.
  DrainArena() = default;
  explicit DrainArena(DeltaList& deltas)
      : scratch_(&deltas.scratch()), resource_(buffer_.data(), buffer_.size(), scratch_) {}
  ~DrainArena() {
    resource_.release();
    if (scratch_ != nullptr) scratch_->reset();
  }
  DrainArena(const DrainArena&) = delete;
  DrainArena& operator=(const DrainArena&) = delete;

  [[nodiscard]] std::pmr::memory_resource* resource() { return &resource_; }

 private:
  ScratchMemory* scratch_ = nullptr;
  alignas(16) std::array<std::byte, 8192> buffer_;
  std::pmr::monotonic_buffer_resource resource_{buffer_.data(), buffer_.size()};
};

/// The ops of one drain with the slots that they concern, by kind.
template <class Scalar, int Dim>
struct ResolvedOps {
  struct Entry {
    Slot slot;
    const CellOp<Scalar, Dim>* op;
  };
  using Entries = std::pmr::vector<Entry>;

  Entries inserts;
  Entries updates;
  Entries erases;

  /// Looks every object up, then gives the new ones slots. Throws std::invalid_argument that names the object before
  /// any slot is given when an insert names a present object, or an update or erase an absent one.
  ResolvedOps(std::span<const CellOp<Scalar, Dim>> ops, ObjectSlots& slots, std::pmr::memory_resource* memory)
      : inserts(memory), updates(memory), erases(memory) {
    updates.reserve(ops.size());
    for (const auto& op : ops) {
      const Slot slot = slots.find(op.object);
      if ((slot == ObjectSlots::kAbsent) != (op.kind == OpKind::kInsert)) refuse_op(op);
      (op.kind == OpKind::kInsert ? inserts : op.kind == OpKind::kUpdate ? updates : erases).push_back({slot, &op});
    }
    for (Entry& entry : inserts) entry.slot = slots.acquire(entry.op->object);
  }
};

}  // namespace sweepgrid
