#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "scenes/scene_source.hpp"

namespace sweepgrid::accuracy {

/// A box and whose it is.
struct Extent {
  SceneBox box;
  std::size_t owner = 0;
};

/// Pairs of extents that meet on `axis`. O(n log n).
[[nodiscard]] inline std::uint64_t count_meetings(const std::vector<Extent>& extents, std::size_t axis) {
  std::vector<double> mins;
  mins.reserve(extents.size());
  for (const Extent& extent : extents) mins.push_back(extent.box.min[axis]);
  std::sort(mins.begin(), mins.end());
  std::uint64_t count = 0;
  for (const Extent& extent : extents) {
    count += static_cast<std::uint64_t>(std::upper_bound(mins.begin(), mins.end(), extent.box.max[axis]) -
                                        std::upper_bound(mins.begin(), mins.end(), extent.box.min[axis]));
  }
  return count;
}

/// Calls `found(a, b)` with the owners of every two extents whose closed boxes overlap: a sort by min and a sweep along
/// the axis where fewest meet. Changes the order of `extents`.
template <class Found>
void for_each_meeting(std::vector<Extent>& extents, Found&& found) {
  std::size_t along = 0;
  std::uint64_t fewest = count_meetings(extents, 0);
  for (std::size_t axis = 1; axis < 3; ++axis) {
    const std::uint64_t count = count_meetings(extents, axis);
    if (count < fewest) fewest = count, along = axis;
  }
  std::sort(extents.begin(), extents.end(),
            [along](const Extent& a, const Extent& b) { return a.box.min[along] < b.box.min[along]; });
  for (std::size_t i = 0; i < extents.size(); ++i) {
    const SceneBox& box = extents[i].box;
    for (std::size_t j = i + 1; j < extents.size() && extents[j].box.min[along] <= box.max[along]; ++j) {
      if (box.overlaps(extents[j].box)) found(extents[i].owner, extents[j].owner);
    }
  }
}

}  // namespace sweepgrid::accuracy
