#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <sweepgrid/grid/cell_code.hpp>

namespace sweepgrid {

/// Which cells exist, by code: a hash of blocks of neighbouring cells. Space without objects takes no memory.
/// Not thread-safe; find() and for_each() may run at once.
template <int Dim>
class CellDirectory {
 public:
  using CellId = std::uint32_t;
  static constexpr CellId kAbsent = 0xffffffffU;

  /// The cell's id, or kAbsent. O(1).
  [[nodiscard]] CellId find(std::uint64_t code) const {
    const Block* block = lookup(CellCode<Dim>::block(code));
    return block == nullptr ? kAbsent : block->cells[CellCode<Dim>::inner(code)];
  }

  /// The ids of a block's cells by inner number, or null when it has none. Good until the next call that changes it.
  [[nodiscard]] const CellId* find_block(std::uint64_t name) const {
    const Block* block = lookup(name);
    return block == nullptr ? nullptr : block->cells.data();
  }

  /// The place of the cell's id, kAbsent when new; to be written by the caller, who then calls added(). Good until the
  /// next call.
  [[nodiscard]] CellId& place(std::uint64_t code) {
    const std::uint64_t name = CellCode<Dim>::block(code);
    Block* block = const_cast<Block*>(lookup(name));
    if (block == nullptr) block = insert(name);
    return block->cells[CellCode<Dim>::inner(code)];
  }

  /// Counts a cell that place() made room for.
  void added(std::uint64_t code) {
    ++const_cast<Block*>(lookup(CellCode<Dim>::block(code)))->used;
    ++size_;
  }

  /// Forgets a cell. Precondition: it exists.
  void erase(std::uint64_t code) {
    const std::uint64_t name = CellCode<Dim>::block(code);
    Block* block = const_cast<Block*>(lookup(name));
    block->cells[CellCode<Dim>::inner(code)] = kAbsent;
    --size_;
    if (--block->used == 0) erase_block(name);
  }

  /// Cells that exist.
  [[nodiscard]] std::size_t size() const { return size_; }

  /// Calls `visit` with the code of every cell, in no order.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const Bucket& bucket : buckets_) {
      if (!bucket.block) continue;
      for (std::uint32_t inner = 0; inner < CellCode<Dim>::kBlockCells; ++inner) {
        if (bucket.block->cells[inner] != kAbsent) visit(bucket.name << CellCode<Dim>::kBlockShift | inner);
      }
    }
  }

  /// Calls `visit` with the id of every cell, to be changed, in no order.
  template <class Visit>
  void for_each_id(Visit&& visit) {
    for (const Bucket& bucket : buckets_) {
      if (!bucket.block) continue;
      for (CellId& id : bucket.block->cells) {
        if (id != kAbsent) visit(id);
      }
    }
  }

  [[nodiscard]] std::size_t bytes() const { return buckets_.capacity() * sizeof(Bucket) + blocks_ * sizeof(Block); }

 private:
  struct Block {
    std::array<CellId, CellCode<Dim>::kBlockCells> cells;
    std::uint32_t used = 0;
  };
  struct Bucket {
    std::uint64_t name = 0;
    std::unique_ptr<Block> block;  // null: free
  };

  // The bucket of a block, or the free one where it belongs. Precondition: a free bucket exists.
  [[nodiscard]] std::size_t bucket_of(std::uint64_t name) const {
    const std::size_t mask = buckets_.size() - 1;
    std::size_t index = CellCode<Dim>::hash(name) & mask;
    while (buckets_[index].block && buckets_[index].name != name) index = (index + 1) & mask;
    return index;
  }

  [[nodiscard]] const Block* lookup(std::uint64_t name) const {
    return buckets_.empty() ? nullptr : buckets_[bucket_of(name)].block.get();
  }

  Block* insert(std::uint64_t name) {
    if (4 * (blocks_ + 1) > buckets_.size()) rehash(std::max<std::size_t>(8, 2 * buckets_.size()));
    auto block = std::make_unique<Block>();
    block->cells.fill(kAbsent);
    Bucket& bucket = buckets_[bucket_of(name)];
    bucket.name = name;
    bucket.block = std::move(block);
    ++blocks_;
    return bucket.block.get();
  }

  // Backward-shift deletion: no tombstones.
  void erase_block(std::uint64_t name) {
    const std::size_t mask = buckets_.size() - 1;
    std::size_t hole = bucket_of(name);
    for (std::size_t next = (hole + 1) & mask; buckets_[next].block; next = (next + 1) & mask) {
      const std::size_t home = CellCode<Dim>::hash(buckets_[next].name) & mask;
      if (((next - home) & mask) >= ((next - hole) & mask)) {
        buckets_[hole] = std::move(buckets_[next]);
        hole = next;
      }
    }
    buckets_[hole].block.reset();
    --blocks_;
    if (buckets_.size() > 64 && 32 * blocks_ < buckets_.size()) rehash(std::bit_ceil(8 * blocks_ + 8));
  }

  void rehash(std::size_t capacity) {
    std::vector<Bucket> old(capacity);
    old.swap(buckets_);
    for (Bucket& bucket : old) {
      if (bucket.block) buckets_[bucket_of(bucket.name)] = std::move(bucket);
    }
  }

  std::vector<Bucket> buckets_;  // open addressing, linear probing, a power of two, at most a quarter full
  std::size_t blocks_ = 0;
  std::size_t size_ = 0;
};

}  // namespace sweepgrid
