#include "study/accuracy/play.hpp"

#include <memory>
#include <numeric>
#include <span>

#include "measure/stopwatch.hpp"
#include "setup/scene_engine.hpp"

namespace sweepgrid::study {
namespace {

class Player {
 public:
  Player(const EngineSetup& setup, const KnownScene& scene)
      : engine_(make_scene_engine(setup, scene.info.dim)), handles_(scene.objects) {}

  const Events<SceneKey>& step(const KnownStep& step) {
    engine_->convert(step.inserted_boxes, step.updated_boxes);
    const std::vector<Handle> made =
        engine_->queue(handles_of(step.erased, erased_), step.inserted_keys, handles_of(step.updated, updated_));
    for (std::size_t i = 0; i < made.size(); ++i) handles_[step.inserted[i]] = made[i];
    return engine_->step();
  }

  [[nodiscard]] const SceneEngine& engine() const { return *engine_; }

 private:
  std::span<const Handle> handles_of(const std::vector<std::uint32_t>& objects, std::vector<Handle>& chosen) const {
    chosen.clear();
    for (const std::uint32_t object : objects) chosen.push_back(handles_[object]);
    return chosen;
  }

  std::unique_ptr<SceneEngine> engine_;
  std::vector<Handle> handles_;  // by object number
  std::vector<Handle> erased_;
  std::vector<Handle> updated_;
};

template <class Stopwatch>
Play play_timed(const EngineSetup& setup, const KnownScene& scene, const Listener& listen) {
  constexpr double kMilli = 1e3;
  Player player(setup, scene);
  Play result;
  for (const KnownStep& step : scene.steps) {
    const Stopwatch watch;
    const Events<SceneKey>& events = player.step(step);
    result.times_ms.push_back(kMilli * watch.seconds());
    if (!listen(events)) break;
  }
  const double sum = std::accumulate(result.times_ms.begin() + 1, result.times_ms.end(), 0.0);
  result.step_ms = sum / static_cast<double>(scene.steps.size() - 1);
  result.report = player.engine().envelope_report();
  result.stats = player.engine().stats();
  return result;
}

}  // namespace

Play play(const EngineSetup& setup, const KnownScene& scene, const Listener& listen) {
  if (setup.config.threads == 1) return play_timed<ThreadStopwatch>(setup, scene, listen);
  return play_timed<WallStopwatch>(setup, scene, listen);
}

EngineSetup setup_of(const Configuration& configuration, const KnownScene& scene) {
  EngineSetup setup;
  setup.treatment = covering(configuration.door, scene.world);
  setup.treatment.axes = {0, 1, 2};
  setup.config.threads = 1;
  setup.config.envelope = configuration.envelope;
  if (setup.config.envelope) setup.config.envelope->margin *= scene.width * scale_of(setup.treatment);
  return setup;
}

Play play(const Configuration& configuration, const KnownScene& scene, const Listener& listen) {
  return play(setup_of(configuration, scene), scene, listen);
}

}  // namespace sweepgrid::study
