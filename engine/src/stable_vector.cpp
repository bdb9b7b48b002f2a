#include <sweepgrid/engine/stable_vector.hpp>

#include <algorithm>
#include <new>

namespace sweepgrid {
namespace {

void* allocate(std::size_t bytes, std::size_t alignment) {
  return alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__ ? ::operator new(bytes)
                                                       : ::operator new (bytes, std::align_val_t{alignment});
}

// No conditional expression: clang 14 calls both functions for one.
void deallocate(void* block, std::size_t alignment) {
  if (alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__) {
    ::operator delete(block);
  } else {
    ::operator delete (block, std::align_val_t{alignment});
  }
}

}  // namespace

void StableBlocks::grow(std::uint64_t size) {
  while (capacity_ < size) {
    const std::uint64_t added = capacity_ == 0 ? kFirst : capacity_;
    void* const block = allocate(static_cast<std::size_t>(added) * element_size_, alignment_);
    blocks_[blocks_used_] = block;
    bases_[blocks_used_] =
        reinterpret_cast<std::uintptr_t>(block) - static_cast<std::uintptr_t>(first_of(blocks_used_)) * element_size_;
    ++blocks_used_;
    capacity_ += added;
  }
  if (size > this->size()) size_.store(size, std::memory_order_release);
}

void StableBlocks::shrink(std::uint64_t size) {
  while (blocks_used_ > 0 && first_of(blocks_used_ - 1) >= size) {
    --blocks_used_;
    deallocate(blocks_[blocks_used_], alignment_);
    capacity_ = first_of(blocks_used_);
  }
  size_.store(std::min(this->size(), capacity_), std::memory_order_release);
}

}  // namespace sweepgrid
