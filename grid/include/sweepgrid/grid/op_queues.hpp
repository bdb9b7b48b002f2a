#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <sweepgrid/grid/grid_spec.hpp>
#include <sweepgrid/sap/cell_op.hpp>

namespace sweepgrid {

/// The ops of one step on their way to cells. Blocks of objects write, groups of cells read; each [block][group] list
/// has one writer and one reader, so neither needs a lock, and reading blocks in order keeps the order of object ids.
template <class Scalar, int Dim>
class OpQueues {
 public:
  struct Routed {
    CellIndex cell;
    CellOp<Scalar, Dim> op;
  };

  /// Empties the queues and gives them `blocks` writers and `groups` (a power of two) readers. Memory that the latest
  /// step did not use is returned, but for a little slack.
  void reset(std::size_t blocks, std::size_t groups) {
    for (auto& list : lists_) {
      const std::size_t wanted = list.size() + list.size() / 8;
      const bool wasteful = list.capacity() > 64 && wanted + wanted / 8 < list.capacity();
      if (wasteful) std::vector<Routed>().swap(list);
      list.clear();
      if (wasteful) list.reserve(wanted);
    }
    lists_.resize(blocks * groups);
    blocks_ = blocks;
    groups_ = groups;
  }

  [[nodiscard]] std::size_t blocks() const { return blocks_; }
  [[nodiscard]] std::size_t groups() const { return groups_; }

  /// Neighbouring cells go to different groups, so that a crowded region spreads over all of them.
  [[nodiscard]] std::size_t group_of(CellIndex cell) const { return cell & (groups_ - 1); }

  void push(std::size_t block, CellIndex cell, const CellOp<Scalar, Dim>& op) {
    lists_[block * groups_ + group_of(cell)].push_back({cell, op});
  }

  [[nodiscard]] std::span<const Routed> list(std::size_t block, std::size_t group) const {
    return lists_[block * groups_ + group];
  }

  [[nodiscard]] std::size_t bytes() const {
    std::size_t total = lists_.capacity() * sizeof(lists_[0]);
    for (const auto& list : lists_) total += list.capacity() * sizeof(Routed);
    return total;
  }

 private:
  std::vector<std::vector<Routed>> lists_;  // [block][group]
  std::size_t blocks_ = 0;
  std::size_t groups_ = 0;
};

}  // namespace sweepgrid
