#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <numeric>

#include <sweepgrid/engine/engine_core.hpp>
#include <sweepgrid/grid/levels.inl.hpp>
#include <sweepgrid/sap/prefetch.hpp>

namespace sweepgrid {

// The first stage of a step: what was queued becomes calls to cells.

namespace engine_core {

/// Blocks of objects for each worker: fewer, because each has a queue to every shard of a grid.
inline constexpr std::size_t kBlocksPerWorker = 3;

}  // namespace engine_core

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::plan_route(std::vector<std::uint64_t>& costs) {
  if (sweeping_) return;
  if (!celled_) {
    make_cells();
    counters_.regrids = 1;
  }
  follow_scene();
  objects_.nothing_queued();
  std::vector<std::uint32_t>& marked = marked_.items;
  if (regridding_) {
    marked.resize(objects_.granules());
    std::iota(marked.begin(), marked.end(), 0);
  }
  const bool small = workers() == 1 || marked.size() < 8;
  const std::size_t wanted = small ? 1 : std::min(marked.size(), engine_core::kBlocksPerWorker * workers());
  blocks_.restart();
  for (std::size_t b = 0; b < wanted; ++b) {
    RouteBlock& block = blocks_.add();
    block.restart();
    block.first = b * marked.size() / wanted;
    block.last = (b + 1) * marked.size() / wanted;
    costs.push_back(block.last - block.first);
  }
  for (const GridIndex grid : levels_.live()) levels_.grid(grid).begin_step(wanted, &budget_);
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::route(std::size_t block) {
  RouteBlock& out = blocks_[block];
  for (std::size_t i = out.first; i < out.last; ++i) route_granule(block, marked_.items[i]);
  for (const GridIndex grid : levels_.live()) {
    levels_.grid(grid).end_block(block);
    out.calls += levels_.grid(grid).calls(block);
  }
}

// First the objects, then what is to be done with them: so their records can be on their way to the cache meanwhile.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::route_granule(std::size_t block, std::uint32_t granule) {
  constexpr std::uint64_t kOnes = ~std::uint64_t{0} / 0xff;  // 1 in each byte
  constexpr std::uint64_t kTops = 0x80 * kOnes;
  objects_.unmark_granule(granule);
  const ObjectId first = granule * Objects::kGranule;
  const std::uint32_t count = std::min(objects_.bound() - first, Objects::kGranule);
  const std::uint8_t wanted = regridding_ ? 0xff : Objects::kQueued;
  const std::uint8_t* const states = &objects_.state(first);  // a granule is contiguous
  std::array<std::uint8_t, Objects::kGranule> chosen;
  std::uint32_t used = 0;
  constexpr std::uint32_t kWord = sizeof(std::uint64_t);
  for (std::uint32_t i = 0; i < count; i += kWord) {
    std::uint64_t bytes = 0;
    std::memcpy(&bytes, states + i, std::min(kWord, count - i));
    bytes &= wanted * kOnes;
    // The top bit of each byte that is not 0.
    std::uint64_t marked = (bytes | ((bytes & ~kTops) + ~kTops)) & kTops;
    for (; marked != 0; marked &= marked - 1) {
      chosen[used++] = static_cast<std::uint8_t>(i + static_cast<std::uint32_t>(std::countr_zero(marked)) / 8);
    }
  }
  Record* const records = &objects_.record(first);
  RouteBlock& out = blocks_[block];
  constexpr std::uint32_t kAhead = 12;
  for (std::uint32_t i = 0; i < std::min(kAhead, used); ++i) sweepgrid::prefetch(&records[chosen[i]]);
  for (std::uint32_t i = 0; i < used; ++i) {
    if (i + kAhead < used) sweepgrid::prefetch(&records[chosen[i + kAhead]]);
    route_object(block, first + chosen[i], records[chosen[i]], out);
  }
}

template <class Scalar, int Dim>
inline void EngineCore<Scalar, Dim>::route_object(std::size_t block, ObjectId object, Record& record, RouteBlock& out) {
  std::uint8_t& state = objects_.state(object);
  if ((state & Objects::kQueued) == Objects::kUpdated) {
    ++out.counters.updates;
    note_change(record, state);
    route_moved(block, object, record, out);
    state = Objects::kLive;
  } else if ((state & Objects::kQueued) != 0) {
    const bool erased = (state & Objects::kErased) != 0;
    if ((state & Objects::kInserted) == 0) {
      note_change(record, state);
      ++out.counters.erases;
      if (!regridding_) levels_.grid(record.grid).route_erase(block, object, record.before);
      show(block, object, record.grid, &record.before, nullptr);
    } else if (!erased) {
      note_change(record, state);
      ++out.counters.inserts;
      record.grid = levels_.home(LevelsType::width(record.box));
      levels_.grid(record.grid).route_insert(block, object, record.box);
      show(block, object, record.grid, nullptr, &record.box);
    }
    if (erased) {
      out.retired.items.push_back(object);
      objects_.retire(object);
      return;
    }
    state = Objects::kLive;
  } else if (regridding_) {
    levels_.grid(record.grid).route_insert(block, object, record.box);
  }
}

template <class Scalar, int Dim>
inline void EngineCore<Scalar, Dim>::note_change(Record& record, std::uint8_t state) const {
  record.change = state;
  record.changed_at = steps_ + 1;
  record.grid_before = record.grid;
}

template <class Scalar, int Dim>
inline void EngineCore<Scalar, Dim>::route_moved(std::size_t block, ObjectId object, Record& record, RouteBlock& out) {
  const double width = LevelsType::width(record.box);
  GridType& grid = levels_.grid(record.grid);
  if (regridding_) {
    grid.route_insert(block, object, record.box);
  } else if (levels_.holds(record.grid, width)) {
    out.counters.migrations += grid.route_update(block, object, record.before, record.box) ? 1 : 0;
    if (levels_.live().size() > 1) show(block, object, record.grid, &record.before, &record.box);
  } else {  // too wide for its grid: it leaves for another, and the two sides of the step are shown apart
    ++out.counters.migrations;
    grid.route_erase(block, object, record.before);
    show(block, object, record.grid, &record.before, nullptr);
    record.grid = levels_.home(width);
    levels_.grid(record.grid).route_insert(block, object, record.box);
    show(block, object, record.grid, nullptr, &record.box);
  }
}

// Shows a changed object to the other grids. In coarser ones it meets everybody; in finer ones only those that rest,
// for the others are shown to its own grid.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::show(std::size_t block, ObjectId object, GridIndex home, const BoxType* before,
                                   const BoxType* after) {
  for (const GridIndex other : levels_.live()) {
    if (other == home) continue;
    levels_.grid(other).route_visit(block, object, before, after, !levels_.coarser(other, home));
  }
}

}  // namespace sweepgrid
