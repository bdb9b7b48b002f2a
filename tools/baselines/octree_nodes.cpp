#include "baselines/octree_nodes.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <string>
#include <utility>

namespace sweepgrid::baselines {

template <class Scalar>
OctreeNodes<Scalar>::OctreeNodes(std::size_t leaf_size, OctreeCounters& counters)
    : leaf_size_(leaf_size), counters_(counters), nodes_(1) {}

template <class Scalar>
void OctreeNodes<Scalar>::reset(const Cell& root) {
  nodes_.assign(1, Node{});
  nodes_[kRoot].cell = root;
  free_.clear();
  inner_entries_ = 0;
  for (Placement& placement : placements_) placement.home = kNone;
}

template <class Scalar>
void OctreeNodes<Scalar>::put(ObjectId object, const BoxType& box) {
  if (object >= placements_.size()) placements_.resize(std::size_t{object} + 1);
  const Entry before{placements_[object].box, object};
  NodeId node = placements_[object].home;
  // Before anything moves: a merge corrects the homes of all that it takes up.
  placements_[object].box = box;
  if (node == kNone) {
    placements_[object].home = kRoot;
    insert(kRoot, {box, object});
  } else {
    ++counters_.moves;
    const NodeId above = home_above(node, box);
    counters_.relocations += above == node ? 0 : 1;
    placements_[object].home = above;
    move(above, before, box);
    node = nodes_[placements_[object].home].parent;
    while (node != kNone && merge_if_sparse(node)) node = nodes_[node].parent;
  }
  placements_[object].home = home_below(placements_[object].home, box);
}

template <class Scalar>
void OctreeNodes<Scalar>::take(ObjectId object) {
  if (object >= placements_.size() || placements_[object].home == kNone) return;
  const NodeId home = std::exchange(placements_[object].home, kNone);
  NodeId node = nodes_[home].parent;
  erase(home, {placements_[object].box, object});
  while (node != kNone && merge_if_sparse(node)) node = nodes_[node].parent;
}

/// The smallest node at or above `from` that holds all of `box` and is not below where the box must stay: cells at the
/// root's border hold boxes that are wider than they seem.
template <class Scalar>
auto OctreeNodes<Scalar>::home_above(NodeId from, const BoxType& box) const -> NodeId {
  while (from != kRoot) {
    const NodeId parent = nodes_[from].parent;
    if (nodes_[from].cell.holds(box) && !nodes_[parent].cell.too_wide_for_children(box)) break;
    from = parent;
  }
  return from;
}

/// The smallest node at or below `from` that holds all of `box`. Precondition: `from` does.
template <class Scalar>
auto OctreeNodes<Scalar>::home_below(NodeId from, const BoxType& box) const -> NodeId {
  while (!ends_at(from, box)) {
    const unsigned met = nodes_[from].cell.children_met(box);
    if (!std::has_single_bit(met)) break;
    from = nodes_[from].children + static_cast<NodeId>(std::countr_zero(met));
  }
  return from;
}

// ---- boxes, at and below a node

template <class Scalar>
void OctreeNodes<Scalar>::insert(NodeId node, const Entry& entry) {
  if (ends_at(node, entry.box)) {
    add(node, entry);
    split_if_full(node);
  } else {
    for_children(node, nodes_[node].cell.children_met(entry.box), [&](NodeId child) { insert(child, entry); });
  }
}

template <class Scalar>
void OctreeNodes<Scalar>::erase(NodeId node, const Entry& entry) {
  if (ends_at(node, entry.box)) {
    drop(node, entry);
  } else {
    for_children(node, nodes_[node].cell.children_met(entry.box), [&](NodeId child) { erase(child, entry); });
    merge_if_sparse(node);
  }
}

template <class Scalar>
void OctreeNodes<Scalar>::move(NodeId node, const Entry& from, const BoxType& to) {
  const bool ended = ends_at(node, from.box);
  const bool ends = ends_at(node, to);
  if (ended && ends) {
    rewrite(node, from, to);
  } else if (ended || ends) {
    erase(node, from);
    insert(node, {to, from.object});
  } else {
    const unsigned left = nodes_[node].cell.children_met(from.box);
    const unsigned entered = nodes_[node].cell.children_met(to);
    for_children(node, left & entered, [&](NodeId child) { move(child, from, to); });
    for_children(node, entered & ~left, [&](NodeId child) { insert(child, {to, from.object}); });
    for_children(node, left & ~entered, [&](NodeId child) { erase(child, from); });
    if (left != entered) merge_if_sparse(node);
  }
}

// ---- the list of one node

template <class Scalar>
void OctreeNodes<Scalar>::add(NodeId node, const Entry& entry) {
  Node& to = nodes_[node];
  to.entries.push_back(entry);
  to.wide += to.cell.too_wide_for_children(entry.box) ? 1 : 0;
  if (to.parent != kNone) ++nodes_[to.parent].in_children;
  inner_entries_ += leaf(node) ? 0 : 1;
}

template <class Scalar>
void OctreeNodes<Scalar>::drop(NodeId node, const Entry& entry) {
  Node& from = nodes_[node];
  find(node, entry.object) = from.entries.back();
  from.entries.pop_back();
  from.wide -= from.cell.too_wide_for_children(entry.box) ? 1 : 0;
  if (from.parent != kNone) --nodes_[from.parent].in_children;
  inner_entries_ -= leaf(node) ? 0 : 1;
}

template <class Scalar>
void OctreeNodes<Scalar>::rewrite(NodeId node, const Entry& from, const BoxType& to) {
  find(node, from.object).box = to;
  const Cell& cell = nodes_[node].cell;
  nodes_[node].wide -= cell.too_wide_for_children(from.box) ? 1 : 0;
  nodes_[node].wide += cell.too_wide_for_children(to) ? 1 : 0;
  // A box that shrank may be one too many.
  split_if_full(node);
}

template <class Scalar>
auto OctreeNodes<Scalar>::find(NodeId node, ObjectId object) -> Entry& {
  return *std::find_if(nodes_[node].entries.begin(), nodes_[node].entries.end(),
                       [object](const Entry& entry) { return entry.object == object; });
}

template <class Scalar>
void OctreeNodes<Scalar>::split_if_full(NodeId node) {
  if (!leaf(node) || nodes_[node].entries.size() - nodes_[node].wide <= leaf_size_) return;
  if (!nodes_[node].cell.divisible()) return;
  ++counters_.nodes_split;
  if (free_.empty()) {
    free_.push_back(static_cast<NodeId>(nodes_.size()));
    nodes_.resize(nodes_.size() + 8);
  }
  const NodeId children = free_.back();
  free_.pop_back();
  for (unsigned number = 0; number < 8; ++number) {
    nodes_[children + number].cell = nodes_[node].cell.child(number);
    nodes_[children + number].parent = node;
  }
  std::vector<Entry> entries = std::exchange(nodes_[node].entries, {});
  nodes_[node].wide = 0;
  if (nodes_[node].parent != kNone) {
    nodes_[nodes_[node].parent].in_children -= static_cast<std::uint32_t>(entries.size());
  }
  nodes_[node].children = children;
  for (const Entry& entry : entries) insert(node, entry);
}

/// Half full at most after a merge, so that neither a split nor another merge is near.
template <class Scalar>
bool OctreeNodes<Scalar>::merge_if_sparse(NodeId node) {
  if (leaf(node) || nodes_[node].in_children > leaf_size_ / 2) return false;
  const NodeId children = nodes_[node].children;
  for (NodeId child = children; child < children + 8; ++child) {
    if (!leaf(child)) return false;
  }
  ++counters_.nodes_merged;
  std::vector<Entry> entries;
  for (NodeId child = children; child < children + 8; ++child) {
    for (const Entry& entry : nodes_[child].entries) {
      const auto same = [&](const Entry& other) { return other.object == entry.object; };
      if (std::none_of(entries.begin(), entries.end(), same)) entries.push_back(entry);
      NodeId& home = placements_[entry.object].home;
      if (home == child) home = node;
    }
    nodes_[child] = Node{};
  }
  free_.push_back(children);
  inner_entries_ -= nodes_[node].entries.size();
  nodes_[node].children = kNone;
  nodes_[node].in_children = 0;
  for (const Entry& entry : entries) add(node, entry);
  return true;
}

// ---- the rest

template <class Scalar>
std::size_t OctreeNodes<Scalar>::bytes() const {
  std::size_t total =
      nodes_.capacity() * sizeof(Node) + free_.capacity() * sizeof(NodeId) + placements_.capacity() * sizeof(Placement);
  for (const Node& node : nodes_) total += node.entries.capacity() * sizeof(Entry);
  return total;
}

template <class Scalar>
void OctreeNodes<Scalar>::validate() const {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw std::logic_error("octree: " + what);
  };
  std::size_t expected = 0;
  for (ObjectId object = 0; object < placements_.size(); ++object) {
    const BoxType& box = placements_[object].box;
    const NodeId home = placements_[object].home;
    if (home == kNone) continue;
    const std::string name = "object " + std::to_string(object);
    NodeId from = home;
    while (nodes_[from].parent != kNone) from = nodes_[from].parent;
    require(from == kRoot, "the home of " + name + " is no node in use");
    require(home == kRoot || nodes_[home].cell.holds(box), "the home of " + name + " does not hold its box");
    std::vector<NodeId> ways{kRoot};
    while (!ways.empty()) {
      const NodeId node = ways.back();
      ways.pop_back();
      if (!ends_at(node, box)) {
        for_children(node, nodes_[node].cell.children_met(box), [&](NodeId child) { ways.push_back(child); });
        continue;
      }
      ++expected;
      const auto is_it = [&, id = object](const Entry& entry) { return entry.object == id && entry.box == box; };
      require(std::count_if(nodes_[node].entries.begin(), nodes_[node].entries.end(), is_it) == 1,
              name + " is missing in a node that it meets, or is there twice");
    }
  }
  std::size_t entries = 0;
  std::size_t inner = 0;
  for (const Node& node : nodes_) {
    entries += node.entries.size();
    inner += node.children == kNone ? 0 : node.entries.size();
    require(node.children != kNone || node.entries.size() - node.wide <= leaf_size_ || !node.cell.divisible(),
            "a leaf is overfull");
  }
  require(entries == expected, "a node holds objects that do not meet it");
  require(inner == inner_entries_, "lists of inner nodes are not counted right");
}

template class OctreeNodes<float>;
template class OctreeNodes<double>;

}  // namespace sweepgrid::baselines
