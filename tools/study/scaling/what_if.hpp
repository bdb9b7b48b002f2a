#pragma once

#include <string>
#include <vector>

#include <sweepgrid/scheduler/work_graph.hpp>

#include "study/scaling/scene.hpp"

namespace sweepgrid::study {

/// The work of a scene's steps as it would be with other tasks.
struct CutVariant {
  std::string what;   ///< "grain" or "shards"
  double factor = 1;  ///< of the grain, or of the number of shards, against what the engine chooses
  std::vector<WorkGraph> steps;
};

/// Grain: tasks of all stages as they are cut for a half and a quarter of the workers' share each (1/2, 1/4), as they
/// are, and 2, 4 and 8 neighbours as one. Shards: the tasks and plan of the stage `gather`, of which there is one for
/// each shard, as they are for 1/4 to 4 times as many workers; all else stays.
[[nodiscard]] std::vector<CutVariant> cut_variants(const SceneScript& scene, int workers, int runs);

}  // namespace sweepgrid::study
