#include "watched_heap.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <new>

#include "sanitized.hpp"
#ifdef SWEEPGRID_ADDRESS_SANITIZED
#include <sanitizer/asan_interface.h>
#else
#define ASAN_POISON_MEMORY_REGION(address, bytes) static_cast<void>(address), static_cast<void>(bytes)
#define ASAN_UNPOISON_MEMORY_REGION(address, bytes) static_cast<void>(address), static_cast<void>(bytes)
#endif

namespace {

std::atomic<std::int64_t> held = 0;
std::atomic<std::int64_t> asked = 0;

std::atomic<bool> failing = false;
bool of_all_threads = true;
thread_local bool of_this_thread = false;
std::atomic<std::int64_t> number = 0;
std::atomic<std::int64_t> failures = 0;
std::int64_t first_failure = 0;
std::int64_t end_of_failures = 0;

constexpr std::size_t kHeader = __STDCPP_DEFAULT_NEW_ALIGNMENT__;

// The size is written in front of what is given out, as far as that is aligned.
std::size_t header_of(std::size_t alignment) { return std::max(alignment, kHeader); }

void count_or_fail() {
  if (!failing.load(std::memory_order_acquire) || !(of_all_threads || of_this_thread)) return;
  const std::int64_t own = number.fetch_add(1);
  if (own < first_failure || own >= end_of_failures) return;
  ++failures;
  throw std::bad_alloc();
}

void* allocate(std::size_t bytes, std::size_t alignment) {
  count_or_fail();
  const std::size_t header = header_of(alignment);
  // Of malloc() no more than is asked for, so that the address sanitizer sees what lies behind it.
  const std::size_t rounded = (header + bytes + header - 1) / header * header;
  void* const memory = header > kHeader ? std::aligned_alloc(header, rounded) : std::malloc(header + bytes);
  if (memory == nullptr) throw std::bad_alloc();
  held += static_cast<std::int64_t>(bytes);
  ++asked;
  std::byte* const given = static_cast<std::byte*>(memory) + header;
  std::memcpy(given - sizeof(bytes), &bytes, sizeof(bytes));
  ASAN_POISON_MEMORY_REGION(memory, header);
  return given;
}

void* allocate_or_null(std::size_t bytes, std::size_t alignment) noexcept {
  try {
    return allocate(bytes, alignment);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

void release(void* memory, std::size_t alignment) {
  if (memory == nullptr) return;
  std::byte* const given = static_cast<std::byte*>(memory);
  std::byte* const whole = given - header_of(alignment);
  ASAN_UNPOISON_MEMORY_REGION(whole, header_of(alignment));
  std::size_t bytes = 0;
  std::memcpy(&bytes, given - sizeof(bytes), sizeof(bytes));
  held -= static_cast<std::int64_t>(bytes);
  std::free(whole);
}

}  // namespace

void* operator new(std::size_t bytes) { return allocate(bytes, kHeader); }
void* operator new[](std::size_t bytes) { return allocate(bytes, kHeader); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return allocate(bytes, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment) {
  return allocate(bytes, static_cast<std::size_t>(alignment));
}
// Those that throw nothing are the standard library's own way to the above, but not under the address sanitizer.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept { return allocate_or_null(bytes, kHeader); }
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept { return allocate_or_null(bytes, kHeader); }
void* operator new(std::size_t bytes, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return allocate_or_null(bytes, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return allocate_or_null(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { release(memory, kHeader); }
void operator delete[](void* memory) noexcept { release(memory, kHeader); }
void operator delete(void* memory, std::size_t) noexcept { release(memory, kHeader); }
void operator delete[](void* memory, std::size_t) noexcept { release(memory, kHeader); }
void operator delete(void* memory, std::align_val_t alignment) noexcept {
  release(memory, static_cast<std::size_t>(alignment));
}
void operator delete[](void* memory, std::align_val_t alignment) noexcept {
  release(memory, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory, std::size_t, std::align_val_t alignment) noexcept {
  release(memory, static_cast<std::size_t>(alignment));
}
void operator delete[](void* memory, std::size_t, std::align_val_t alignment) noexcept {
  release(memory, static_cast<std::size_t>(alignment));
}

namespace sweepgrid::heap {

std::int64_t bytes() { return held; }
std::int64_t allocations() { return asked; }

Failing::Failing(std::int64_t first, std::int64_t count, Of of) {
  of_all_threads = of == Of::kAllThreads;
  of_this_thread = of == Of::kThisThread;
  number = 0;
  failures = 0;
  first_failure = first;
  end_of_failures = first + count;
  failing.store(true, std::memory_order_release);
}

Failing::~Failing() {
  failing.store(false, std::memory_order_release);
  of_this_thread = false;
}

std::int64_t Failing::failed() const { return failures; }

void may_fail() { count_or_fail(); }

}  // namespace sweepgrid::heap
