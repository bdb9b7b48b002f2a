#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

#include <sweepgrid/sap/high_water.hpp>
#include <sweepgrid/sap/ids.hpp>

namespace sweepgrid {

/// What a cell must hear of an object.
enum class CellCall : std::uint32_t {
  kInsert,  ///< a resident comes
  kUpdate,  ///< a resident has a new box
  kErase,   ///< a resident goes
  // Heard after all of the above:
  kVisit,     ///< an object of another grid had a box here and has one now; either may miss the cell
  kVisitWas,  ///< of another grid, here at the start of the step only
  kVisitIs,   ///< of another grid, here at the end of the step only
};

/// The calls of one step on their way to cells. Blocks of objects write, shards of a grid read; each [block][shard]
/// list has one writer and one reader, so neither needs a lock, and reading blocks in order keeps the order of object
/// ids.
class OpQueues {
 public:
  static constexpr std::uint32_t kMaxCells = (std::uint32_t{1} << 29) - 1;  // in a shard

  /// A call to a cell that exists: eight bytes, for they are written, sorted and read once for each op and cell.
  struct Known {
    std::uint32_t cell : 29;  // its id in the shard
    std::uint32_t call : 3;
    ObjectId object;
  };

  /// A call to a cell that may have to be made.
  struct Fresh {
    std::uint64_t cell;  // its code
    ObjectId object;
    CellCall call;
  };

  struct List {
    std::vector<Known> known;
    std::vector<Fresh> fresh;
    HighWater most_known;
    HighWater most_fresh;

    [[nodiscard]] std::size_t size() const { return known.size() + fresh.size(); }
  };

  /// Gives the queues `blocks` writers and `shards` readers.
  void reset(std::size_t blocks, std::size_t shards) {
    if (blocks == blocks_ && shards == shards_) return;
    lists_.resize(blocks * shards);
    blocks_ = blocks;
    shards_ = shards;
  }

  /// Ends the step of a reader: its lists are emptied, and memory beyond what HighWater allows goes back.
  void note_step(std::size_t shard) {
    for (std::size_t block = 0; block < blocks_; ++block) {
      List& read = list(block, shard);
      read.most_known.recycle(read.known);
      read.most_fresh.recycle(read.fresh);
    }
  }
  /// As note_step() of all readers for so many steps in which nothing was queued.
  void pass(std::size_t steps) {
    for (List& idle : lists_) {
      idle.most_known.pass(steps);
      idle.most_known.release(idle.known);
      idle.most_fresh.pass(steps);
      idle.most_fresh.release(idle.fresh);
    }
  }

  /// Throws std::length_error for more calls to one reader in one step than 32 bits can count.
  static void require_countable(std::uint64_t calls) {
    if (calls > std::numeric_limits<std::uint32_t>::max()) {
      throw std::length_error("sweepgrid: more than 2^32 - 1 calls to the cells of one part of a grid in one step");
    }
  }

  /// Calls that a writer has queued.
  [[nodiscard]] std::size_t written(std::size_t block) const {
    std::size_t total = 0;
    for (std::size_t shard = 0; shard < shards_; ++shard) total += lists_[block * shards_ + shard].size();
    return total;
  }

  [[nodiscard]] std::size_t blocks() const { return blocks_; }
  [[nodiscard]] List& list(std::size_t block, std::size_t shard) { return lists_[block * shards_ + shard]; }

  [[nodiscard]] std::size_t bytes() const {
    std::size_t total = lists_.capacity() * sizeof(List);
    for (const List& list : lists_) {
      total += list.known.capacity() * sizeof(Known) + list.fresh.capacity() * sizeof(Fresh);
    }
    return total;
  }

 private:
  std::vector<List> lists_;  // [block][shard]
  std::size_t blocks_ = 0;
  std::size_t shards_ = 0;
};

}  // namespace sweepgrid
