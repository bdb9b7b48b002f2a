#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace sweepgrid {

/// Raw memory for elements of one size by 32-bit index, which never move: blocks that double in size. While one thread
/// grows it, others may use elements that exist. Nothing is constructed or destroyed.
class StableBlocks {
 public:
  StableBlocks(std::size_t element_size, std::size_t alignment) : element_size_(element_size), alignment_(alignment) {}
  ~StableBlocks() { shrink(0); }
  StableBlocks(const StableBlocks&) = delete;
  StableBlocks& operator=(const StableBlocks&) = delete;

  /// Elements [0, size()) exist. Thread-safe beside grow().
  [[nodiscard]] std::uint64_t size() const { return size_.load(std::memory_order_acquire); }

  /// Makes elements [0, size) exist. Throws std::bad_alloc, and then some may. Not thread-safe beside itself.
  void grow(std::uint64_t size);

  /// Gives back the blocks that lie wholly beyond the first `size` elements. Not thread-safe beside anything.
  void shrink(std::uint64_t size);

  /// Heap bytes held: whole blocks. Not thread-safe beside grow().
  [[nodiscard]] std::size_t bytes() const { return static_cast<std::size_t>(capacity_) * element_size_; }

  /// Of the element. In the innermost loops: a few instructions and no branch. `element_size`: what it was made with.
  [[nodiscard]] void* address(std::uint32_t index, std::size_t element_size) const {
    const int block = std::bit_width(index | (kFirst - 1)) - kFirstBits;
    // A base may lie outside of its block, where no pointer may be.
    const std::uintptr_t place = bases_[static_cast<std::size_t>(block)] + std::uintptr_t{index} * element_size;
    return reinterpret_cast<void*>(place);  // NOLINT(performance-no-int-to-ptr)
  }
  [[nodiscard]] void* address(std::uint32_t index) const { return address(index, element_size_); }

 private:
  static constexpr int kFirstBits = 9;
  static constexpr std::uint32_t kFirst = std::uint32_t{1} << kFirstBits;
  static constexpr std::size_t kBlocks = 32 - kFirstBits + 1;

  static std::uint64_t first_of(std::size_t block) {
    return block == 0 ? 0 : std::uint64_t{1} << (kFirstBits + block - 1);
  }

  std::array<std::uintptr_t, kBlocks> bases_{};  // of blocks: where index 0 would lie
  std::array<void*, kBlocks> blocks_{};
  std::size_t blocks_used_ = 0;
  std::uint64_t capacity_ = 0;
  std::atomic<std::uint64_t> size_ = 0;
  std::size_t element_size_;
  std::size_t alignment_;
};

/// As StableBlocks, of one type. New elements are not initialised.
template <class T>
class StableVector : private StableBlocks {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  StableVector() : StableBlocks(sizeof(T), alignof(T)) {}

  [[nodiscard]] T& operator[](std::uint32_t index) { return *static_cast<T*>(address(index, sizeof(T))); }
  [[nodiscard]] const T& operator[](std::uint32_t index) const {
    return *static_cast<const T*>(address(index, sizeof(T)));
  }

  using StableBlocks::bytes;
  using StableBlocks::grow;
  using StableBlocks::shrink;
  using StableBlocks::size;
};

}  // namespace sweepgrid
