#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

namespace sweepgrid {

/// An array by 32-bit index whose elements never move: blocks that double in size. While one thread grows it, others
/// may use elements that exist. New elements are default-initialised (trivial types: not at all).
template <class T>
class StableVector {
 public:
  [[nodiscard]] T& operator[](std::uint32_t index) { return *address(index); }
  [[nodiscard]] const T& operator[](std::uint32_t index) const { return *address(index); }

  /// Elements [0, size()) exist. Thread-safe beside grow().
  [[nodiscard]] std::uint64_t size() const { return size_.load(std::memory_order_acquire); }

  /// Makes elements [0, size) exist. Not thread-safe beside itself.
  void grow(std::uint64_t size) {
    while (capacity_ < size) {
      const std::size_t added = capacity_ == 0 ? kFirst : static_cast<std::size_t>(capacity_);
      blocks_[blocks_used_] = std::make_unique_for_overwrite<T[]>(added);
      bases_[blocks_used_] =
          reinterpret_cast<std::uintptr_t>(blocks_[blocks_used_].get()) - first_of(blocks_used_) * sizeof(T);
      ++blocks_used_;
      capacity_ += added;
    }
    if (size > this->size()) size_.store(size, std::memory_order_release);
  }

  /// Gives back the blocks that lie wholly beyond the first `size` elements. Not thread-safe beside anything.
  void shrink(std::uint64_t size) {
    while (blocks_used_ > 0 && first_of(blocks_used_ - 1) >= size) {
      --blocks_used_;
      blocks_[blocks_used_].reset();
      capacity_ = first_of(blocks_used_);
    }
    size_.store(std::min(this->size(), capacity_), std::memory_order_release);
  }

  /// Memory in use. What was never asked for of the last block counts only where it is initialised; else it has
  /// addresses, but no pages.
  [[nodiscard]] std::size_t bytes() const {
    return static_cast<std::size_t>(std::is_trivially_default_constructible_v<T> ? size() : capacity_) * sizeof(T);
  }

 private:
  static constexpr int kFirstBits = 9;
  static constexpr std::uint32_t kFirst = std::uint32_t{1} << kFirstBits;
  static constexpr int kBlocks = 32 - kFirstBits + 1;

  // In the innermost loops: a few instructions and no branch.
  [[nodiscard]] T* address(std::uint32_t index) const {
    const int block = std::bit_width(index | (kFirst - 1)) - kFirstBits;
    // A base may lie outside of its block, where no pointer may be.
    const std::uintptr_t place = bases_[block] + std::uintptr_t{index} * sizeof(T);
    return reinterpret_cast<T*>(place);  // NOLINT(performance-no-int-to-ptr)
  }
  static std::uint64_t first_of(int block) { return block == 0 ? 0 : std::uint64_t{1} << (kFirstBits + block - 1); }

  std::array<std::uintptr_t, kBlocks> bases_{};  // of blocks: where index 0 would lie
  std::array<std::unique_ptr<T[]>, kBlocks> blocks_;
  int blocks_used_ = 0;
  std::uint64_t capacity_ = 0;
  std::atomic<std::uint64_t> size_ = 0;
};

}  // namespace sweepgrid
