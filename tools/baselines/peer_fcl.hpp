#pragma once

#include <cstdint>
#include <memory>

#include "baselines/peer_system.hpp"

namespace sweepgrid::baselines {

/// Whether FCL's tree is built anew in each step, or moves the leaves of the objects that moved.
enum class FclUpkeep { kRebuild, kUpdate };

/// fcl::DynamicAABBTreeCollisionManager over the boxes themselves: exact. There with SWEEPGRID_WITH_FCL only.
[[nodiscard]] std::unique_ptr<System> make_fcl(FclUpkeep upkeep, std::uint32_t objects);

}  // namespace sweepgrid::baselines
