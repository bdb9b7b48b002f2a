#pragma once

#include <memory>
#include <vector>

#include "accuracy/scene_pair.hpp"
#include "scenes/scene_source.hpp"

namespace sweepgrid::accuracy {

/// What is held to be true of a pair in a step. Objects that a step erases are in no pair of it.
enum class TruthKind {
  kInstants,  ///< T0: the closed boxes overlap at the end of the step
  kMotion,    ///< T1: boxes that move linearly through the step overlap at some time in it, its two ends included
  kShapes,    ///< T2: the closed shapes that the boxes bound touch at the end of the step
};

/// Tells which pairs are true after each step of a scene, exactly, from nothing but the scene: no code of the engine,
/// and rational arithmetic wherever doubles do not decide.
class Truth {
 public:
  virtual ~Truth() = default;

  /// Applies the scene's next step and returns the pairs that are true of it, sorted; good until the next call.
  /// Precondition: every box is valid (bad input is for methods to refuse).
  virtual const std::vector<ScenePair>& step(const SceneStep& step) = 0;
};

/// A truth for a scene of these shapes. O(n log n + c) per step, c: pairs whose extents meet on the axis where fewest
/// do.
///
/// T1: an object is not there before the step that inserts it. An endpoint that is infinite at one end of the step is
/// infinite between the ends.
/// T2: of a scene of boxes it is T0. Spheres are inscribed: their diameter is the least edge of the box, so that the
/// shape never leaves its box whatever was rounded. Boxes of spheres must be finite.
[[nodiscard]] std::unique_ptr<Truth> make_truth(TruthKind kind, const SceneInfo& scene);

}  // namespace sweepgrid::accuracy
