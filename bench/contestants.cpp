#include "contestants.hpp"

#include "engine_setting.hpp"
#include "system.hpp"

namespace sweepgrid::bench {

std::vector<Contestant> peers() {
  std::vector<Contestant> peers;
#ifdef SWEEPGRID_WITH_BULLET
  peers.push_back({"bullet", "btDbvtBroadphase, exact boxes, events from the pair cache", make_bullet});
#endif
#ifdef SWEEPGRID_WITH_FCL
  constexpr std::uint32_t kMostForFcl = 200000;
  const auto fcl = [](FclUpkeep upkeep) {
    return [upkeep](std::uint32_t objects) { return make_fcl(upkeep, objects); };
  };
  peers.push_back({"fcl", "DynamicAABBTreeCollisionManager, moved leaves updated; no events", fcl(FclUpkeep::kUpdate),
                   kMostForFcl});
  peers.push_back({"fcl_rebuilt", "the same, rebuilt in each step; no events", fcl(FclUpkeep::kRebuild), kMostForFcl});
#endif
#ifdef SWEEPGRID_WITH_CGAL
  peers.push_back({"cgal", "box_self_intersection_d in each step; no events", make_cgal});
#endif
#ifdef SWEEPGRID_WITH_EMBREE
  const auto embree = [](EmbreeUpkeep upkeep) {
    return [upkeep](std::uint32_t objects) { return make_embree(upkeep, objects); };
  };
  peers.push_back({"embree", "rtcCollide, rebuilt in each step; no events", embree(EmbreeUpkeep::kRebuild)});
  peers.push_back(
      {"embree_refit", "the same, refitted while nothing is inserted; no events", embree(EmbreeUpkeep::kRefit)});
#endif
  return peers;
}

std::optional<Contestant> find_contestant(std::string_view name, const EngineOptions& options) {
  for (const Contestant& peer : peers()) {
    if (peer.name == name) return peer;
  }
  auto config = engine_setting(name);
  if (!config) return std::nullopt;
  if (options.population) config->cell_population = *options.population;
  if (options.segment_capacity) config->cell.segment_capacity = *options.segment_capacity;
  const auto make = [config = *config, single_calls = options.single_calls](std::uint32_t objects) {
    return std::make_unique<EngineSystem>(config, single_calls, objects);
  };
  return Contestant{std::string(name), "the engine", make};
}

}  // namespace sweepgrid::bench
