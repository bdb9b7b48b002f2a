#pragma once

#include <cstdint>
#include <memory>

#include "accuracy/engine_system.hpp"
#include "baselines/peer_bullet.hpp"
#include "baselines/peer_fcl.hpp"
#include "baselines/peer_system.hpp"
#include "scenes/scene_script.hpp"

namespace sweepgrid::bench {

// What the benchmarks share with the studies.
using accuracy::EngineSystem;
using baselines::EventTotals;
using baselines::FclUpkeep;
using baselines::make_bullet;
using baselines::make_fcl;
using baselines::ObjectPair;
using baselines::System;
using baselines::SystemMaker;

[[nodiscard]] std::unique_ptr<System> make_cgal(std::uint32_t objects);

/// Whether Embree's hierarchy is built anew in each step, or keeps its shape and only grows and shrinks its boxes.
enum class EmbreeUpkeep { kRebuild, kRefit };
[[nodiscard]] std::unique_ptr<System> make_embree(EmbreeUpkeep upkeep, std::uint32_t objects);

}  // namespace sweepgrid::bench
