// Not fcl::collide(), which would compile the tests of all its shapes; for two boxes it calls this one.
#include <fcl/narrowphase/detail/primitive_shape_algorithm/box_box.h>

#include "baselines/peer_narrow_phase.hpp"

namespace sweepgrid::baselines {
namespace {

fcl::Transform3<float> transform(const PlacedBox& box) {
  fcl::Transform3<float> transform = fcl::Transform3<float>::Identity();
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      const auto& axis = box.axes[static_cast<std::size_t>(column)];
      transform.linear()(row, column) = axis[static_cast<std::size_t>(row)];
    }
  }
  transform.translation() << box.centre[0], box.centre[1], box.centre[2];
  return transform;
}

fcl::Box<float> shape(const PlacedBox& box) { return {2 * box.half[0], 2 * box.half[1], 2 * box.half[2]}; }

}  // namespace

std::size_t fcl_touching(const PlacedPairs& pairs) {
  std::size_t touching = 0;
  std::vector<fcl::ContactPoint<float>> contacts;
  for (const auto& [a, b] : pairs) {
    contacts.clear();
    const bool touch = fcl::detail::boxBoxIntersect(shape(a), transform(a), shape(b), transform(b), &contacts);
    touching += touch ? 1 : 0;
  }
  return touching;
}

}  // namespace sweepgrid::baselines
