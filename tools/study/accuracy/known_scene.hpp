#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "accuracy/scene_pair.hpp"
#include "accuracy/truth.hpp"
#include "scenes/scene_numbering.hpp"
#include "scenes/scene_source.hpp"

namespace sweepgrid::study {

/// One step of a scene, with objects numbered densely: number k is always the same object.
struct KnownStep {
  std::vector<std::uint32_t> erased;
  std::vector<std::uint32_t> inserted;
  std::vector<SceneKey> inserted_keys;
  std::vector<SceneBox> inserted_boxes;
  std::vector<std::uint32_t> updated;
  std::vector<SceneBox> updated_boxes;
};

/// The pairs of a truth after each step.
struct KnownTruth {
  accuracy::TruthKind kind;
  std::vector<std::vector<ScenePair>> pairs;
};

/// A scene in memory, with all that is true of it. In two dimensions z is [0, 0].
struct KnownScene {
  SceneInfo info;                  ///< its name is as open_scene() takes it
  std::uint32_t objects = 0;       ///< numbers are below this
  double width = 0;                ///< the median of the mean edges of the first objects
  SceneBox world;                  ///< holds every box
  std::vector<KnownStep> steps;    ///< the first is the start
  std::vector<KnownTruth> truths;  ///< of know_scene(): T0 and T1; and T2 where the objects are no boxes
};

/// Makes a known scene of one step after the other.
class KnownSceneBuilder {
 public:
  KnownSceneBuilder(const SceneInfo& info, const std::vector<accuracy::TruthKind>& truths);

  /// The next step; the first is the start. Throws SceneError that names scene, step and object when a box is not valid
  /// or not finite, or that there are no objects at the start.
  void take(const SceneStep& step);
  /// To be called once, last.
  [[nodiscard]] KnownScene finish();

 private:
  void check(const std::vector<SceneKey>& keys, const std::vector<SceneBox>& boxes);

  std::vector<std::unique_ptr<accuracy::Truth>> truths_;
  SceneNumbering numbering_;
  bool empty_ = true;  // no box has been seen
  KnownScene scene_;
};

/// Reads at most `steps` steps after the start. Throws what open_scene() throws, and SceneError that names scene, step
/// and object when a box is not valid or not finite, or that there are no objects or no steps.
[[nodiscard]] KnownScene know_scene(const std::string& name, std::uint64_t steps);

}  // namespace sweepgrid::study
