#pragma once

#include "scenes/scene_source.hpp"

namespace sweepgrid::accuracy {

/// Two instants of a box that moves linearly between them.
struct MovingBox {
  SceneBox before;
  SceneBox after;
};

/// Tests that are exact for every input: they judge in double with a bound of the error, and in rational numbers where
/// that does not decide. Everything is closed: what touches meets.

/// Whether the two overlap at some time, both instants included. An endpoint that is infinite at one instant is
/// infinite between them (a min with both signs is -infinity, a max with both +infinity).
[[nodiscard]] bool meet_in_motion(const MovingBox& a, const MovingBox& b);

/// Whether the spheres (circles in two dimensions) around the centres of the boxes touch whose diameters are the least
/// edges. Precondition: finite.
[[nodiscard]] bool spheres_touch(const SceneBox& a, const SceneBox& b, int dim);

/// Whether the two touch. Precondition: finite, and the half edges of each span space.
[[nodiscard]] bool oriented_boxes_touch(const OrientedBox& a, const OrientedBox& b);

}  // namespace sweepgrid::accuracy
