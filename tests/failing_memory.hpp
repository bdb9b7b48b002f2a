#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

/// Allocations of the program that are counted, and that fail on demand. To be included by one file of a program.
namespace sweepgrid::oracle {

class FailingMemory {
 public:
  /// From now on allocations are numbered from 0, and `count` of them from `first` on fail.
  static void start(std::int64_t first, std::int64_t count) {
    number_ = 0;
    first_ = first;
    end_ = first + count;
    on_.store(true, std::memory_order_release);
  }
  /// Returns how many there have been since start().
  static std::int64_t stop() {
    on_.store(false, std::memory_order_release);
    return number_;
  }

  static void* allocate(std::size_t bytes, std::size_t alignment) {
    if (on_.load(std::memory_order_acquire)) {
      const std::int64_t own = number_.fetch_add(1);
      if (own >= first_ && own < end_) throw std::bad_alloc();
    }
    void* memory = nullptr;
    if (posix_memalign(&memory, alignment, bytes == 0 ? 1 : bytes) != 0) throw std::bad_alloc();
    return memory;
  }

  static constexpr std::int64_t kAllAfter = std::int64_t{1} << 40;

 private:
  static inline std::atomic<bool> on_ = false;
  static inline std::atomic<std::int64_t> number_ = 0;
  static inline std::int64_t first_ = 0;
  static inline std::int64_t end_ = 0;
};

}  // namespace sweepgrid::oracle

// NOLINTBEGIN(misc-definitions-in-headers): one file includes this.
void* operator new(std::size_t bytes) {
  return sweepgrid::oracle::FailingMemory::allocate(bytes, alignof(std::max_align_t));
}
void* operator new[](std::size_t bytes) { return operator new(bytes); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return sweepgrid::oracle::FailingMemory::allocate(bytes, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment) { return operator new(bytes, alignment); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
// NOLINTEND(misc-definitions-in-headers)
