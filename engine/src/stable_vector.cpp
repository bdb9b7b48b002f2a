#include <sweepgrid/engine/stable_vector.hpp>

#include <algorithm>
#include <new>

namespace sweepgrid {

void StableBlocks::grow(std::uint64_t size) {
  while (capacity_ < size) {
    const std::uint64_t added = capacity_ == 0 ? kFirst : capacity_;
    void* const block = ::operator new (static_cast<std::size_t>(added) * element_size_, std::align_val_t{alignment_});
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
    ::operator delete (blocks_[blocks_used_], std::align_val_t{alignment_});
    capacity_ = first_of(blocks_used_);
  }
  size_.store(std::min(this->size(), capacity_), std::memory_order_release);
}

}  // namespace sweepgrid
