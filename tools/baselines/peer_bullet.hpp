#pragma once

#include <cstdint>
#include <memory>

#include "baselines/peer_system.hpp"

namespace sweepgrid::baselines {

/// There with SWEEPGRID_WITH_BULLET only. Bullet's memory comes from operator new then, so that running out of it is
/// std::bad_alloc.

/// btDbvtBroadphase without margins: exact.
[[nodiscard]] std::unique_ptr<System> make_bullet(std::uint32_t objects);

/// Bits of a coordinate in Bullet's sweep and prune.
enum class AxisSweepBits { k16, k32 };

/// Most objects of a btAxisSweep3; the other has no limit that memory does not reach first.
inline constexpr std::uint32_t kMostObjectsOfAxisSweep16 = 32766;

/// btAxisSweep3 or bt32BitAxisSweep3: coordinates are whole numbers within a world that is given beforehand. Boxes grow
/// outward when they are rounded, and are pressed to its border when they lie outside: superset only. `objects`: their
/// numbers are below; `at_once`: how many there are at most at any time.
/// Throws std::length_error for more objects than it can have.
[[nodiscard]] std::unique_ptr<System> make_bullet_axis_sweep(AxisSweepBits bits, const FloatBox& world,
                                                             std::uint32_t objects, std::uint32_t at_once);

}  // namespace sweepgrid::baselines
