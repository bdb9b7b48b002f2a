#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <sweepgrid/engine/events.hpp>
#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/sap/ids.hpp>

#include "baselines/octree_nodes.hpp"

namespace sweepgrid::baselines {

/// Settings of a DynamicOctree; the default is measured (tools/baselines/README.md).
struct OctreeOptions {
  /// A leaf with more boxes than this is cut in eight; at least 1.
  int leaf_size = 32;
};

/// The paper's baseline (section 4): a dynamic octree after Vemuri, Cao and Chen (1998). Its nodes hold growable arrays
/// of boxes, which are passed over whole. An object that moves looks upward in the tree from where it was, and then
/// downward, so that small moves touch few nodes.
///
/// Each object remembers what it overlaps. So a step tests again what changed objects overlapped, and passes over the
/// lists that they meet; objects at rest cost nothing. The root is fitted to the objects, and fitted anew when many
/// have left it; those outside are in the cells at its border. Not thread-safe. Instantiated for float and double.
template <class Scalar>
class DynamicOctree {
 public:
  using BoxType = Box<Scalar, 3>;

  /// Throws std::invalid_argument for a leaf size below 1.
  explicit DynamicOctree(const OctreeOptions& options = {});

  // The nodes count into counters_.
  DynamicOctree(const DynamicOctree&) = delete;
  DynamicOctree& operator=(const DynamicOctree&) = delete;

  /// Objects are dense numbers that the caller chooses. Takes effect at the next step(), like update() and erase().
  /// Throws std::invalid_argument when `object` is present, or for a box with a NaN or min > max; then nothing changes.
  void insert(ObjectId object, const BoxType& box);

  /// The last update before a step wins. Throws std::invalid_argument when `object` is absent, or for a bad box.
  void update(ObjectId object, const BoxType& box);

  /// Throws std::invalid_argument when `object` is absent. Inserted again before the next step, it ends its old pairs,
  /// then begins its new ones.
  void erase(ObjectId object);

  /// The net change of the set of overlapping pairs since the last step, in the engine's order. Valid until the next
  /// call. O(changed objects * their neighbours) as long as leaves are small.
  const Events<ObjectId>& step();

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const OctreeCounters& counters() const { return counters_; }

  /// Heap bytes held, unused capacity included.
  [[nodiscard]] std::size_t bytes() const;

  /// Checks, after a step, that each box is where it should be and that pairs are known from both sides. Throws
  /// std::logic_error that says what is wrong. Slow.
  void validate() const;

 private:
  struct Object {
    BoxType box;
    bool present = false;
    bool changed = false;         // since the last step
    std::uint32_t seen = 0;       // the last search that knew it
    std::vector<ObjectId> pairs;  // what it overlaps, as far as it is known
  };

  Object& require_present(ObjectId object);
  static void require_valid(ObjectId object, const BoxType& box);
  void change(ObjectId object, const BoxType& box);
  void place_changed();
  void fit_root();
  void end_pairs(ObjectId object);
  void begin_pairs(ObjectId object);

  OctreeCounters counters_;
  OctreeNodes<Scalar> nodes_;
  std::size_t leaf_size_;
  std::vector<Object> objects_;    // by ObjectId
  std::vector<ObjectId> changed_;  // some may be gone again
  std::size_t outsiders_ = 0;      // boxes placed outside the root since it was fitted
  std::uint32_t search_ = 0;
  std::size_t size_ = 0;
  Events<ObjectId> pending_;
  Events<ObjectId> events_;
};

}  // namespace sweepgrid::baselines
