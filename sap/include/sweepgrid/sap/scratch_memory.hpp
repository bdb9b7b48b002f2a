#pragma once

#include <algorithm>
#include <cstddef>
#include <memory_resource>
#include <new>
#include <utility>
#include <vector>

#include <sweepgrid/sap/high_water.hpp>

namespace sweepgrid {

/// Memory that drains of cells use one after another, so that cells keep none of their own and a drain allocates
/// nothing once another has needed as much: what is given out is taken back all at once.
///
/// Not thread-safe: one for each worker.
class ScratchMemory final : public std::pmr::memory_resource {
 public:
  ScratchMemory() = default;
  ~ScratchMemory() override { free_blocks(); }
  ScratchMemory(ScratchMemory&& other) noexcept { swap(other); }
  ScratchMemory& operator=(ScratchMemory&& other) noexcept {
    ScratchMemory(std::move(other)).swap(*this);
    return *this;
  }
  ScratchMemory(const ScratchMemory&) = delete;
  ScratchMemory& operator=(const ScratchMemory&) = delete;

  /// Takes back all that was given out. What took several blocks will have one the next time.
  void reset() {
    if (used_ == 0) [[likely]]
      return;
    most_ = std::max(most_, used_);
    used_ = 0;
    if (blocks_.size() > 1) free_blocks();
    if (!blocks_.empty()) blocks_[0].used = 0;
  }

  /// Ends a step: memory beyond what HighWater allows goes back. Precondition: reset().
  void note_step() {
    water_.note(std::exchange(most_, 0));
    release();
  }
  /// As note_step() for so many steps in which nothing was used.
  void pass(std::size_t steps) {
    water_.pass(steps);
    release();
  }

  /// Heap bytes held.
  [[nodiscard]] std::size_t bytes() const { return blocks_.capacity() * sizeof(Block) + room(); }

 private:
  static constexpr std::size_t kAlignment = alignof(std::max_align_t);

  struct Block {
    std::byte* data;
    std::size_t size;
    std::size_t used;
  };

  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    if (alignment > kAlignment) throw std::bad_alloc();  // nobody asks for more
    bytes = (bytes + kAlignment - 1) / kAlignment * kAlignment;
    used_ += bytes;
    if (blocks_.empty() || blocks_.back().size - blocks_.back().used < bytes) add_block(std::max(bytes, most_));
    Block& block = blocks_.back();
    return block.data + std::exchange(block.used, block.used + bytes);
  }
  void do_deallocate(void* /*memory*/, std::size_t /*bytes*/, std::size_t /*alignment*/) override {}
  [[nodiscard]] bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
    return this == &other;
  }

  void add_block(std::size_t size) {
    blocks_.reserve(blocks_.size() + 1);
    blocks_.push_back({static_cast<std::byte*>(::operator new(size)), size, 0});
  }
  void free_blocks() noexcept {
    for (const Block& block : blocks_) ::operator delete(block.data);
    blocks_.clear();
  }
  [[nodiscard]] std::size_t room() const {
    std::size_t total = 0;
    for (const Block& block : blocks_) total += block.size;
    return total;
  }
  void release() {
    if (room() <= water_.allowed()) return;
    free_blocks();
    std::vector<Block>().swap(blocks_);
  }
  void swap(ScratchMemory& other) noexcept {
    blocks_.swap(other.blocks_);
    std::swap(used_, other.used_);
    std::swap(most_, other.most_);
    std::swap(water_, other.water_);
  }

  std::vector<Block> blocks_;  // only the last one is not full
  std::size_t used_ = 0;       // since reset()
  std::size_t most_ = 0;       // in this step
  HighWater water_;
};

}  // namespace sweepgrid
