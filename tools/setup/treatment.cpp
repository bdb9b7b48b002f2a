#include "setup/treatment.hpp"

#include <sweepgrid/sap/quantizer.hpp>

namespace sweepgrid {

Treatment covering(Door door, const SceneBox& world) {
  Treatment treatment;
  treatment.door = door;
  if (!is_integer(door)) return treatment;
  for (std::size_t axis = 0; axis < 3; ++axis) treatment.origin[axis] = world.min[axis] / 2 + world.max[axis] / 2;
  treatment.resolution = door == Door::kInt16 ? Quantizer<std::int16_t, 3>::covering(world).resolution()
                                              : Quantizer<std::int32_t, 3>::covering(world).resolution();
  return treatment;
}

}  // namespace sweepgrid
