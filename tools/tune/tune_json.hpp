#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "tune/demand.hpp"
#include "tune/exhaustive.hpp"
#include "tune/scene_facts.hpp"
#include "tune/scene_sample.hpp"
#include "tune/tuner.hpp"

namespace sweepgrid::tune {

/// All that a run of tune() came to.
struct Tuning {
  SceneText scene;
  Demand demand;
  SceneSample sample;
  SceneFacts facts;
  TuneResult result;
  double seconds = 0;  ///< processor time, reading included
  std::optional<ExhaustiveResult> exhaustive;
};

/// The chosen setup as `run --config` takes it, with all about the choice in its member "tune" (tools/README.md).
[[nodiscard]] nlohmann::ordered_json tune_json(const Tuning& tuning);

/// The choice, the reasons, and what came next, for people.
[[nodiscard]] std::string tune_text(const Tuning& tuning);

}  // namespace sweepgrid::tune
