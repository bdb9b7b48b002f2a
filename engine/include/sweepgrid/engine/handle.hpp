#pragma once

#include <cstdint>

namespace sweepgrid {

/// Names an object of one engine: faster than its key. Stale once the object is erased, and recognised as stale even
/// when its index serves a later object.
struct Handle {
  std::uint32_t index = 0xffffffffU;
  std::uint32_t generation = 0;

  friend bool operator==(Handle, Handle) = default;
};

}  // namespace sweepgrid
