#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

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
  // Heard last, and no news:
  kAttach,  ///< a resident comes from another grid
  kDetach,  ///< a resident goes to another grid
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

    [[nodiscard]] std::size_t size() const { return known.size() + fresh.size(); }
  };

  /// Gives the queues `blocks` writers and `shards` readers. Each writer is to begin_block() before it writes.
  void reset(std::size_t blocks, std::size_t shards) {
    if (blocks == blocks_ && shards == shards_) return;
    lists_.resize(blocks * shards);
    blocks_ = blocks;
    shards_ = shards;
  }

  /// Empties the lists of a writer. Memory that the latest step did not use is returned, but for a little slack.
  void begin_block(std::size_t block) {
    for (std::size_t shard = 0; shard < shards_; ++shard)
      clear(list(block, shard).known), clear(list(block, shard).fresh);
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
  template <class T>
  static void clear(std::vector<T>& list) {
    if (list.capacity() == 0) return;
    const std::size_t wanted = list.size() + list.size() / 8;
    const bool wasteful = list.capacity() > 64 && wanted + wanted / 8 < list.capacity();
    if (wasteful) std::vector<T>().swap(list);
    list.clear();
    if (wasteful) list.reserve(wanted);
  }

  std::vector<List> lists_;  // [block][shard]
  std::size_t blocks_ = 0;
  std::size_t shards_ = 0;
};

}  // namespace sweepgrid
