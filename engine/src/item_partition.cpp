#include <sweepgrid/engine/item_partition.hpp>

#include <bit>

namespace sweepgrid {

ObjectPartition::ObjectPartition(Executor& executor, std::span<const Handle> objects)
    : count_(objects.size()), ranges_(Lists::chunks(objects.size())) {
  // Clients often keep their handles in the order in which they got them: then ranges of items already are apart.
  struct Extent {
    std::uint32_t lowest;
    std::uint32_t highest;
  };
  std::vector<Extent> extents(ranges_);
  executor.for_each(ranges_, [&](std::size_t range) {
    const auto [first, end] = Lists::chunk(range, count_);
    Extent extent{objects[first].index, objects[first].index};
    for (std::size_t item = first; item < end; ++item) {
      extent.lowest = std::min(extent.lowest, objects[item].index);
      extent.highest = std::max(extent.highest, objects[item].index);
    }
    extents[range] = extent;
  });
  std::sort(extents.begin(), extents.end(), [](const Extent& a, const Extent& b) { return a.lowest < b.lowest; });
  const auto shared = std::adjacent_find(extents.begin(), extents.end(),
                                         [](const Extent& a, const Extent& b) { return a.highest >= b.lowest; });
  if (shared == extents.end()) return;

  // By ranges of ids, which also keeps what one worker touches close together.
  std::uint32_t highest = 0;
  for (const Extent& extent : extents) highest = std::max(highest, extent.highest);
  const std::uint32_t lowest = extents.front().lowest;
  const std::size_t wanted = std::min<std::size_t>(ranges_, 4 * static_cast<std::size_t>(executor.concurrency()));
  const int shift = std::bit_width((highest - lowest) / wanted);
  lists_.assign(
      executor, count_, ((highest - lowest) >> shift) + 1,
      [&](std::size_t item) { return (objects[item].index - lowest) >> shift; },
      [](std::size_t item) { return static_cast<std::uint32_t>(item); });
}

}  // namespace sweepgrid
