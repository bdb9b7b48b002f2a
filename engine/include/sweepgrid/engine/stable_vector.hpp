#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace sweepgrid {

/// An array by 32-bit index whose elements never move: blocks that double in size. While one thread grows it, others
/// may use elements that exist. New elements are default-initialised (trivial types: not at all).
template <class T>
class StableVector {
 public:
  [[nodiscard]] T& operator[](std::uint32_t index) { return blocks_[block(index)][offset(index)]; }
  [[nodiscard]] const T& operator[](std::uint32_t index) const { return blocks_[block(index)][offset(index)]; }

  /// Makes elements [0, size) exist. Not thread-safe beside itself.
  void grow(std::uint64_t size) {
    while (capacity_ < size) {
      const std::size_t added = capacity_ == 0 ? kFirst : capacity_;
      blocks_[blocks_used_++] = std::make_unique_for_overwrite<T[]>(added);
      capacity_ += added;
    }
  }

  [[nodiscard]] std::size_t bytes() const { return static_cast<std::size_t>(capacity_) * sizeof(T); }

 private:
  static constexpr int kFirstBits = 9;
  static constexpr std::size_t kFirst = std::size_t{1} << kFirstBits;

  static int block(std::uint32_t index) { return std::bit_width(index >> kFirstBits); }
  static std::uint32_t offset(std::uint32_t index) {
    const int b = block(index);
    return b == 0 ? index : index & ((std::uint32_t{1} << (kFirstBits + b - 1)) - 1);
  }

  std::array<std::unique_ptr<T[]>, 32 - kFirstBits + 1> blocks_;
  int blocks_used_ = 0;
  std::uint64_t capacity_ = 0;
};

}  // namespace sweepgrid
