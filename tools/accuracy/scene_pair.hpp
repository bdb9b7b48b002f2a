#pragma once

#include <sweepgrid/engine/events.hpp>

#include "scenes/scene_source.hpp"

namespace sweepgrid {

using ScenePair = Pair<SceneKey>;

/// By key of the first, then of the second.
struct ScenePairOrder {
  bool operator()(const ScenePair& a, const ScenePair& b) const {
    return a.first != b.first ? a.first < b.first : a.second < b.second;
  }
};

}  // namespace sweepgrid
