#include "study/accuracy/play.hpp"

#include <span>
#include <vector>

#include <sweepgrid/engine/engine.hpp>
#include <sweepgrid/sap/quantizer.hpp>
#include <sweepgrid/sap/rounding.hpp>

#include "measure/stopwatch.hpp"
#include "scenes/rounded_step.hpp"

namespace sweepgrid::study {
namespace {

// `convert` makes an engine's box of a scene's; `scale`: of the engine's units to those of the scene.
template <class Scalar, class Convert>
class Player {
 public:
  using EngineType = Engine<Scalar, 3, SceneKey>;
  using BoxType = Box<Scalar, 3>;

  Player(const Configuration& configuration, const KnownScene& scene, double scale, Convert convert)
      : convert_(convert), engine_(config(configuration, scene.width * scale)), handles_(scene.objects) {}

  const Events<SceneKey>& step(const KnownStep& step) {
    if (!step.erased.empty()) engine_.erase(handles_of(step.erased));
    if (!step.inserted.empty()) {
      const std::vector<Handle> made =
          engine_.insert(std::span<const SceneKey>(step.inserted_keys), boxes_of(step.inserted_boxes));
      for (std::size_t i = 0; i < made.size(); ++i) handles_[step.inserted[i]] = made[i];
    }
    if (!step.updated.empty()) engine_.update(handles_of(step.updated), boxes_of(step.updated_boxes));
    return engine_.step();
  }

  [[nodiscard]] EnvelopeReport report() const { return engine_.envelope_report(); }

 private:
  static Config<Scalar, 3> config(const Configuration& configuration, double width) {
    Config<Scalar, 3> config;
    config.threads = 1;
    config.envelope = configuration.envelope;
    if (config.envelope) config.envelope->margin *= width;
    return config;
  }

  std::span<const Handle> handles_of(const std::vector<std::uint32_t>& objects) {
    chosen_.clear();
    for (const std::uint32_t object : objects) chosen_.push_back(handles_[object]);
    return chosen_;
  }

  std::span<const BoxType> boxes_of(const std::vector<SceneBox>& boxes) {
    converted_.clear();
    for (const SceneBox& box : boxes) converted_.push_back(convert_(box));
    return converted_;
  }

  Convert convert_;
  EngineType engine_;
  std::vector<Handle> handles_;  // by object number
  std::vector<Handle> chosen_;
  std::vector<BoxType> converted_;
};

template <class Scalar, class Convert>
Play play_as(const Configuration& configuration, const KnownScene& scene, double scale, Convert convert,
             const Listener& listen) {
  constexpr double kMilli = 1e3;
  Player<Scalar, Convert> player(configuration, scene, scale, convert);
  double seconds = 0;
  for (std::size_t k = 0; k < scene.steps.size(); ++k) {
    const ThreadStopwatch watch;
    const Events<SceneKey>& events = player.step(scene.steps[k]);
    if (k > 0) seconds += watch.seconds();
    if (!listen(events)) break;
  }
  return {kMilli * seconds / static_cast<double>(scene.steps.size() - 1), player.report()};
}

template <class Int>
Play play_quantised(const Configuration& configuration, const KnownScene& scene, const Listener& listen) {
  const auto quantizer = Quantizer<Int, 3>::covering(scene.world);
  return play_as<Int>(configuration, scene, 1 / quantizer.resolution(), quantizer, listen);
}

}  // namespace

Play play(const Configuration& configuration, const KnownScene& scene, const Listener& listen) {
  switch (configuration.door) {
    case Door::kFloatNearest:
      return play_as<float>(
          configuration, scene, 1, [](const SceneBox& box) { return round_box<float, 3>(box); }, listen);
    case Door::kFloatOutward:
      return play_as<float>(
          configuration, scene, 1, [](const SceneBox& box) { return round_outward<float>(box); }, listen);
    case Door::kInt32:
      return play_quantised<std::int32_t>(configuration, scene, listen);
    case Door::kInt16:
      return play_quantised<std::int16_t>(configuration, scene, listen);
    case Door::kDouble:
      break;
  }
  return play_as<double>(
      configuration, scene, 1, [](const SceneBox& box) { return box; }, listen);
}

}  // namespace sweepgrid::study
