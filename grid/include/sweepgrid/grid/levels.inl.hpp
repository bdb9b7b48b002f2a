#pragma once

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <sweepgrid/grid/grid.inl.hpp>
#include <sweepgrid/grid/levels.hpp>

namespace sweepgrid {

template <class Scalar, int Dim>
void Levels<Scalar, Dim>::start_family(double cell_size, const std::array<double, Dim>& origin,
                                       const CellOptions& cells, std::size_t shards) {
  clear();
  cell_size_ = cell_size;
  origin_ = origin;
  cells_ = cells;
  shards_ = shards;
  homes_ = none();
  homes_[0] = add(GridSpec<Scalar, Dim>::unlimited(cell_size, origin), cell_size);
}

template <class Scalar, int Dim>
void Levels<Scalar, Dim>::clear() {
  grids_.clear();
  widest_.clear();
  live_.clear();
  homes_ = none();
}

template <class Scalar, int Dim>
void Levels<Scalar, Dim>::start_single(const GridSpec<Scalar, Dim>& spec, const CellOptions& cells,
                                       std::size_t shards) {
  clear();
  cell_size_ = spec.cell_size();
  cells_ = cells;
  shards_ = shards;
  homes_.fill(add(spec, std::numeric_limits<double>::infinity()));
}

template <class Scalar, int Dim>
GridIndex Levels<Scalar, Dim>::add(const GridSpec<Scalar, Dim>& spec, double widest) {
  std::size_t index = 0;
  while (index < grids_.size() && grids_[index]) ++index;
  if (index == kNone) throw std::length_error("sweepgrid: more than 255 grids");
  if (index == grids_.size()) grids_.emplace_back(), widest_.emplace_back();
  grids_[index] = std::make_unique<GridType>(spec, cells_, shards_);
  widest_[index] = widest;
  const auto name = static_cast<GridIndex>(index);
  live_.insert(std::upper_bound(live_.begin(), live_.end(), name), name);
  return name;
}

template <class Scalar, int Dim>
int Levels<Scalar, Dim>::level_of(double width) const {
  double widest = cell_size_;
  int level = 0;
  while (level < kLevels - 1 && !(width <= widest)) ++level, widest *= kRatio;
  return level;
}

template <class Scalar, int Dim>
bool Levels<Scalar, Dim>::make_room(double widest) {
  const int last = level_of(widest);
  std::uint32_t wanted = wanted_.exchange(0, std::memory_order_relaxed);
  if (std::all_of(homes_.begin() + last, homes_.end(), [](GridIndex home) { return home == kNone; })) {
    wanted |= std::uint32_t{1} << last;
  }
  bool made = false;
  double size = cell_size_;
  for (int level = 0; level < kLevels; ++level, size *= kRatio) {
    if ((wanted >> level & 1) == 0 || homes_[level] != kNone) continue;
    const bool top = level == kLevels - 1;
    homes_[level] = top ? add(GridSpec<Scalar, Dim>(), std::numeric_limits<double>::infinity())
                        : add(GridSpec<Scalar, Dim>::unlimited(size, origin_), size);
    made = true;
  }
  return made;
}

template <class Scalar, int Dim>
GridIndex Levels<Scalar, Dim>::home(double width) const {
  if (width <= cell_size_) return homes_[0];
  const int level = level_of(width);
  int found = level;
  while (homes_[found] == kNone) ++found;
  if (found != level) wanted_.fetch_or(std::uint32_t{1} << level, std::memory_order_relaxed);
  return homes_[found];
}

template <class Scalar, int Dim>
double Levels<Scalar, Dim>::drop_empty() {
  std::erase_if(live_, [&](GridIndex index) {
    if (index == homes_[0] || grids_[index]->cell_count() > 0) return false;
    std::replace(homes_.begin(), homes_.end(), index, kNone);
    grids_[index].reset();
    return true;
  });
  double widest = 0;
  for (const GridIndex home : homes_) widest = home == kNone ? widest : std::max(widest, widest_[home]);
  return widest;
}

}  // namespace sweepgrid
