#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <new>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include <sweepgrid/sap/ids.hpp>

namespace sweepgrid {

/// The memory of a row cell: a row of ids and, for each axis, a row of mins and one of maxes, in one allocation.
/// An object has the same place in every row; places are dense and unordered.
template <class Bits, int Dim>
class RowBlock {
 public:
  /// A coordinate is kept with its top bit flipped, so that signed comparison orders it: AVX2 and older have no other.
  using Value = std::make_signed_t<Bits>;
  static constexpr Bits kFlip = Bits{1} << (8 * sizeof(Bits) - 1);

  static constexpr int kValueRows = 2 * Dim;
  /// Capacity is a multiple of this.
  static constexpr std::uint32_t kGranule = 4;
  /// Rows may be read in whole vectors of up to this size, beyond their end too.
  static constexpr std::size_t kVectorBytes = 64;

  RowBlock() = default;
  RowBlock(RowBlock&& other) noexcept { swap(other); }
  RowBlock& operator=(RowBlock&& other) noexcept {
    RowBlock(std::move(other)).swap(*this);
    return *this;
  }
  RowBlock(const RowBlock&) = delete;
  RowBlock& operator=(const RowBlock&) = delete;
  ~RowBlock() { ::operator delete(data_); }

  [[nodiscard]] std::uint32_t size() const { return size_; }
  [[nodiscard]] const void* data() const { return data_; }
  [[nodiscard]] std::size_t bytes() const { return capacity_ == 0 ? 0 : bytes_for(capacity_); }

  [[nodiscard]] ObjectId* ids() { return reinterpret_cast<ObjectId*>(data_); }
  [[nodiscard]] const ObjectId* ids() const { return reinterpret_cast<const ObjectId*>(data_); }

  /// Row `index` of values: the mins of axes 0 to Dim - 1, then their maxes.
  [[nodiscard]] Value* row(int index) { return reinterpret_cast<Value*>(data_ + row_offset(index)); }
  [[nodiscard]] const Value* row(int index) const { return reinterpret_cast<const Value*>(data_ + row_offset(index)); }

  /// The value at `place` of row `index` as ordered bits.
  [[nodiscard]] Bits bits(int index, std::uint32_t place) const { return static_cast<Bits>(row(index)[place]) ^ kFlip; }
  void set_bits(int index, std::uint32_t place, Bits bits) { row(index)[place] = static_cast<Value>(bits ^ kFlip); }

  /// Makes room for `size` objects in all. The first allocation is exact, and so is every one of few objects. Throws
  /// std::length_error for more than 2^32 - 4.
  void reserve(std::uint64_t size) {
    if (size > capacity_) reallocate(size_ == 0 ? size : size + size / 16);
  }

  /// Gives memory back when much more is held than is used.
  void fit() {
    if (capacity_ - size_ > kGranule + size_ / 8) reallocate(std::uint64_t{size_} + size_ / 16);
  }

  /// Keeps the memory.
  void clear() { size_ = 0; }

  /// Adds an object, whose values are to be written. Precondition: there is room.
  std::uint32_t append(ObjectId object) {
    ids()[size_] = object;
    return size_++;
  }

  /// Removes the object at `place`; the last one moves there.
  void remove(std::uint32_t place) {
    --size_;
    ids()[place] = ids()[size_];
    for (int index = 0; index < kValueRows; ++index) row(index)[place] = row(index)[size_];
  }

 private:
  [[nodiscard]] std::size_t row_offset(int index) const {
    return std::size_t{capacity_} * (sizeof(ObjectId) + static_cast<std::size_t>(index) * sizeof(Value));
  }

  [[nodiscard]] static std::size_t bytes_for(std::size_t capacity) {
    const std::size_t last_row = (capacity * sizeof(Value) + kVectorBytes - 1) / kVectorBytes * kVectorBytes;
    return capacity * (sizeof(ObjectId) + (kValueRows - 1) * sizeof(Value)) + last_row;
  }

  void reallocate(std::uint64_t size) {
    const std::uint64_t capacity = (size + kGranule - 1) / kGranule * kGranule;
    if (capacity > std::numeric_limits<std::uint32_t>::max()) {
      throw std::length_error("sweepgrid: more than 2^32 - 4 objects in one cell");
    }
    RowBlock larger;
    larger.capacity_ = static_cast<std::uint32_t>(capacity);
    if (larger.capacity_ != 0) {
      larger.data_ = static_cast<std::byte*>(::operator new(bytes_for(larger.capacity_)));
      larger.size_ = size_;
      if (size_ != 0) {
        std::memcpy(larger.ids(), ids(), size_ * sizeof(ObjectId));
        for (int index = 0; index < kValueRows; ++index) {
          std::memcpy(larger.row(index), row(index), size_ * sizeof(Value));
        }
      }
    }
    swap(larger);
  }

  void swap(RowBlock& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  std::byte* data_ = nullptr;
  std::uint32_t size_ = 0;
  std::uint32_t capacity_ = 0;
};

}  // namespace sweepgrid
