#include "failing_memory.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

// Of one thread, so that those of other threads neither fail nor count.
struct Failures {
  bool on = false;
  std::uint64_t next = 0;
  std::uint64_t first = 0;
  std::uint64_t count = 0;
  std::uint64_t failed = 0;
};
thread_local Failures failures;

void count_or_fail() {
  if (!failures.on) return;
  const std::uint64_t own = failures.next++;
  if (own < failures.first || own - failures.first >= failures.count) return;
  ++failures.failed;
  throw std::bad_alloc();
}

void* allocate(std::size_t bytes) {
  count_or_fail();
  void* const memory = std::malloc(std::max<std::size_t>(bytes, 1));
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void* allocate(std::size_t bytes, std::align_val_t alignment) {
  count_or_fail();
  const auto unit = static_cast<std::size_t>(alignment);
  void* const memory = std::aligned_alloc(unit, (std::max<std::size_t>(bytes, 1) + unit - 1) / unit * unit);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t bytes) { return allocate(bytes); }
void* operator new[](std::size_t bytes) { return allocate(bytes); }
void* operator new(std::size_t bytes, std::align_val_t alignment) { return allocate(bytes, alignment); }
void* operator new[](std::size_t bytes, std::align_val_t alignment) { return allocate(bytes, alignment); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace sweepgrid::fuzz {

FailingMemory::FailingMemory(std::uint64_t first, std::uint64_t count) {
  failures = {.on = true, .next = 0, .first = first, .count = count, .failed = 0};
}
FailingMemory::~FailingMemory() { failures.on = false; }
std::uint64_t FailingMemory::failed() const { return failures.failed; }
void FailingMemory::may_fail() { count_or_fail(); }

}  // namespace sweepgrid::fuzz
