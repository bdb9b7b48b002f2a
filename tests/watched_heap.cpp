#include "watched_heap.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {

std::atomic<std::int64_t> held = 0;
std::atomic<std::int64_t> asked = 0;

std::atomic<bool> failing = false;
std::atomic<std::int64_t> number = 0;
std::atomic<std::int64_t> failures = 0;
std::int64_t first_failure = 0;
std::int64_t end_of_failures = 0;

constexpr std::size_t kHeader = __STDCPP_DEFAULT_NEW_ALIGNMENT__;

// The size is written in front of what is given out, as far as that is aligned.
std::size_t header_of(std::size_t alignment) { return std::max(alignment, kHeader); }

void* allocate(std::size_t bytes, std::size_t alignment) {
  if (failing.load(std::memory_order_acquire)) {
    const std::int64_t own = number.fetch_add(1);
    if (own >= first_failure && own < end_of_failures) {
      ++failures;
      throw std::bad_alloc();
    }
  }
  const std::size_t header = header_of(alignment);
  const std::size_t total = (header + bytes + header - 1) / header * header;
  void* const memory = header > kHeader ? std::aligned_alloc(header, total) : std::malloc(total);
  if (memory == nullptr) throw std::bad_alloc();
  held += static_cast<std::int64_t>(bytes);
  ++asked;
  std::byte* const given = static_cast<std::byte*>(memory) + header;
  std::memcpy(given - sizeof(bytes), &bytes, sizeof(bytes));
  return given;
}

void release(void* memory, std::size_t alignment) {
  if (memory == nullptr) return;
  std::byte* const given = static_cast<std::byte*>(memory);
  std::size_t bytes = 0;
  std::memcpy(&bytes, given - sizeof(bytes), sizeof(bytes));
  held -= static_cast<std::int64_t>(bytes);
  std::free(given - header_of(alignment));
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

Failing::Failing(std::int64_t first, std::int64_t count) {
  number = 0;
  failures = 0;
  first_failure = first;
  end_of_failures = first + count;
  failing.store(true, std::memory_order_release);
}

Failing::~Failing() { failing.store(false, std::memory_order_release); }

std::int64_t Failing::failed() const { return failures; }

}  // namespace sweepgrid::heap
