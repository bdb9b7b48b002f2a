#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <sweepgrid/sap/box.hpp>
#include <sweepgrid/sap/ids.hpp>

#include "baselines/octree_cell.hpp"

namespace sweepgrid::baselines {

/// Exact counts of an octree's work.
struct OctreeCounters {
  std::uint64_t box_tests = 0;      ///< overlap tests of two boxes while lists are passed over
  std::uint64_t lists_visited = 0;  ///< nodes whose lists were passed over
  std::uint64_t moves = 0;          ///< changed objects that the tree knew before
  std::uint64_t relocations = 0;    ///< of these, those that left the smallest node known to hold them
  std::uint64_t nodes_split = 0;    ///< leaves cut in eight
  std::uint64_t nodes_merged = 0;   ///< nodes that took back what their eight children held
  std::uint64_t roots_fitted = 0;   ///< times that the tree was built anew around the objects
};

/// The nodes of an octree and the boxes in them. A box is in every leaf that it meets, except that it stays in an inner
/// node when it is wider than that node's children: it then is in the at most 8 nodes of that level which it meets. So
/// two boxes that overlap are found on one way from the root to a leaf.
template <class Scalar>
class OctreeNodes {
 public:
  using BoxType = Box<Scalar, 3>;
  using Cell = OctreeCell<Scalar>;

  struct Entry {
    BoxType box;
    ObjectId object;
  };

  /// A leaf with more than `leaf_size` boxes is cut, if that helps.
  OctreeNodes(std::size_t leaf_size, OctreeCounters& counters);

  /// Takes all boxes out, and starts anew with an empty root.
  void reset(const Cell& root);

  /// Gives an object a box: puts it in, or has it look upward from where it was for a node that holds the new box,
  /// and downward from there.
  void put(ObjectId object, const BoxType& box);

  /// Takes an object out. Does nothing if it is not in.
  void take(ObjectId object);

  /// Calls `pass(entries)` with the list of each node that an object's box meets, where it is not empty. All that the
  /// box overlaps is there, perhaps more than once, and so is the object. Precondition: it is in.
  template <class Pass>
  void visit(ObjectId object, Pass&& pass) const;

  [[nodiscard]] const Cell& root() const { return nodes_[kRoot].cell; }
  [[nodiscard]] std::size_t bytes() const;

  /// Throws std::logic_error when a box is not where it should be, or a leaf is not cut that should be.
  void validate() const;

 private:
  using NodeId = std::uint32_t;
  static constexpr NodeId kRoot = 0;
  static constexpr NodeId kNone = 0xffffffffU;

  struct Node {
    Cell cell;
    NodeId parent = kNone;
    NodeId children = kNone;        // the first of eight; kNone in a leaf
    std::uint32_t wide = 0;         // of its entries, those too wide for children
    std::uint32_t in_children = 0;  // entries of its children
    std::vector<Entry> entries;
  };

  struct Placement {
    BoxType box;
    NodeId home = kNone;  // holds all of the box; the smallest such node when the box was put there
  };

  [[nodiscard]] bool leaf(NodeId node) const { return nodes_[node].children == kNone; }
  [[nodiscard]] bool ends_at(NodeId node, const BoxType& box) const {
    return leaf(node) || nodes_[node].cell.too_wide_for_children(box);
  }
  [[nodiscard]] NodeId home_above(NodeId from, const BoxType& box) const;
  [[nodiscard]] NodeId home_below(NodeId from, const BoxType& box) const;
  template <class Act>
  void for_children(NodeId node, unsigned which, Act&& act) const;
  template <class Pass>
  void visit_below(NodeId node, const BoxType& box, Pass& pass) const;

  void insert(NodeId node, const Entry& entry);
  void erase(NodeId node, const Entry& entry);
  void move(NodeId node, const Entry& from, const BoxType& to);
  void add(NodeId node, const Entry& entry);
  void drop(NodeId node, const Entry& entry);
  void rewrite(NodeId node, const Entry& from, const BoxType& to);
  [[nodiscard]] Entry& find(NodeId node, ObjectId object);
  void split_if_full(NodeId node);
  bool merge_if_sparse(NodeId node);

  std::size_t leaf_size_;
  OctreeCounters& counters_;
  std::vector<Node> nodes_;            // the root first, then children by eights
  std::vector<NodeId> free_;           // first children of eights that are not in use
  std::size_t inner_entries_ = 0;      // lists of inner nodes are empty almost everywhere
  std::vector<Placement> placements_;  // by ObjectId
};

template <class Scalar>
template <class Act>
void OctreeNodes<Scalar>::for_children(NodeId node, unsigned which, Act&& act) const {
  for (NodeId number = 0; number < 8; ++number) {
    // The children stay where they are, though the array of nodes may move.
    if ((which >> number & 1U) != 0) act(nodes_[node].children + number);
  }
}

template <class Scalar>
template <class Pass>
void OctreeNodes<Scalar>::visit(ObjectId object, Pass&& pass) const {
  const Placement& placement = placements_[object];
  if (inner_entries_ > 0) {
    for (NodeId node = nodes_[placement.home].parent; node != kNone; node = nodes_[node].parent) {
      if (!nodes_[node].entries.empty()) pass(std::span<const Entry>(nodes_[node].entries));
    }
  }
  visit_below(placement.home, placement.box, pass);
}

template <class Scalar>
template <class Pass>
void OctreeNodes<Scalar>::visit_below(NodeId node, const BoxType& box, Pass& pass) const {
  if (!nodes_[node].entries.empty()) pass(std::span<const Entry>(nodes_[node].entries));
  if (leaf(node)) return;
  for_children(node, nodes_[node].cell.children_met(box), [&](NodeId child) { visit_below(child, box, pass); });
}

}  // namespace sweepgrid::baselines
