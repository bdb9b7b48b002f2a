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
  [[nodiscard]] T& operator[](std::uint32_t index) { return blocks_[block(index)][offset(index)]; }
  [[nodiscard]] const T& operator[](std::uint32_t index) const { return blocks_[block(index)][offset(index)]; }

  /// Elements [0, size()) exist. Thread-safe beside grow().
  [[nodiscard]] std::uint64_t size() const { return size_.load(std::memory_order_acquire); }

  /// Makes elements [0, size) exist. Not thread-safe beside itself.
  void grow(std::uint64_t size) {
    while (capacity_ < size) {
      const std::size_t added = capacity_ == 0 ? kFirst : static_cast<std::size_t>(capacity_);
      blocks_[blocks_used_] = std::make_unique_for_overwrite<T[]>(added);
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
  static constexpr std::size_t kFirst = std::size_t{1} << kFirstBits;

  static int block(std::uint32_t index) { return std::bit_width(index >> kFirstBits); }
  static std::uint32_t offset(std::uint32_t index) {
    const int b = block(index);
    return b == 0 ? index : index & ((std::uint32_t{1} << (kFirstBits + b - 1)) - 1);
  }
  static std::uint64_t first_of(int block) { return block == 0 ? 0 : std::uint64_t{1} << (kFirstBits + block - 1); }

  std::array<std::unique_ptr<T[]>, 32 - kFirstBits + 1> blocks_;
  int blocks_used_ = 0;
  std::uint64_t capacity_ = 0;
  std::atomic<std::uint64_t> size_ = 0;
};

}  // namespace sweepgrid
