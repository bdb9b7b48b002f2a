#pragma once

#include <algorithm>
#include <bit>
#include <vector>

#include <sweepgrid/engine/engine_core.hpp>
#include <sweepgrid/grid/grid_fit.inl.hpp>
#include <sweepgrid/grid/levels.inl.hpp>

namespace sweepgrid {

// How the grids of an engine follow its scene.

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::follow_scene() {
  counting() ? follow_with_counts() : follow_with_levels();
}

template <class Scalar, int Dim>
std::size_t EngineCore<Scalar, Dim>::grid_shards() const {
  const auto workers = static_cast<std::size_t>(executor_->concurrency());
  // Even for one worker, queues that fit into its cache gather faster.
  const std::size_t parts = objects_.size() >> 17;
  return std::bit_ceil(std::clamp<std::size_t>(std::max(parts, workers == 1 ? 1 : 2 * workers), 1, 1024));
}

template <class Scalar, int Dim>
auto EngineCore<Scalar, Dim>::sample(std::size_t count) const -> std::vector<BoxType> {
  std::vector<ObjectId> chosen(count);
  std::vector<BoxType> boxes;
  boxes.reserve(count);
  for (const ObjectId object : objects_.sample(chosen)) boxes.push_back(objects_.record(object).box);
  return boxes;
}

template <class Scalar, int Dim>
auto EngineCore<Scalar, Dim>::fit(const std::vector<BoxType>& boxes) const -> typename GridFit<Scalar, Dim>::Result {
  GridFit<Scalar, Dim> fit;
  fit.cell_size = config_.cell_size;
  if (config_.cell_population) {
    fit.population = *config_.cell_population;
  } else if (config_.cell.kind != CellKind::kRows) {
    fit.population = 48;  // measured for batch cells, see grid/README.md
  }
  return fit.derive(boxes, objects_.size());
}

// All objects move to a new grid in this step, and events come from the difference of the two tables.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::follow_with_counts() {
  if (gridded_ && !regrid_.outgrown(objects_.size()) && !regrid_.crowded()) return;
  const auto result = fit(sample(GridFit<Scalar, Dim>::sample_size(objects_.size())));
  const auto spec = bounded(result);
  if (gridded_ && !regrid_.outgrown(objects_.size()) && spec.cell_size() > 0.75 * levels_.cell_size() &&
      result.share_within(fitted_) > 0.8) {
    return regrid_.resign();
  }
  start_single(result, spec);
  regridding_ = true;
}

// A box over everything is in all cells, so there must not be many more of them than objects.
template <class Scalar, int Dim>
auto EngineCore<Scalar, Dim>::bounded(const typename GridFit<Scalar, Dim>::Result& result) const
    -> GridSpec<Scalar, Dim> {
  const double most_cells = config_.cell_size ? kMaxCells : kFewCells + static_cast<double>(objects_.size());
  return GridFit<Scalar, Dim>::bounded(result, most_cells);
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::start_single(const typename GridFit<Scalar, Dim>::Result& result,
                                           const GridSpec<Scalar, Dim>& spec) {
  fitted_ = result;
  levels_.start_single(spec, config_.cell, grid_shards());
  for (ObjectId object = 0; object < objects_.bound(); ++object) objects_.record(object).grid = levels_.finest();
  regrid_.fitted(result.met, objects_.size());
  gridded_ = true;
  counters_.regrids = 1;
}

// New cells are made in one step for all objects.
template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::follow_with_levels() {
  const std::size_t objects = objects_.size();
  if (!gridded_) {
    const auto boxes = sample(GridFit<Scalar, Dim>::sample_size(objects));
    const auto result = fit(boxes);
    start_family(result.cell_size, result.lower, boxes);
    regrid_.fitted(result.met, objects);
    gridded_ = true;
  } else if (!config_.cell_size && (regrid_.outgrown(objects) || regrid_.crowded() || regrid_.sparse())) {
    const auto boxes = sample(GridFit<Scalar, Dim>::sample_size(objects));
    const auto result = fit(boxes);
    const double change = result.cell_size / levels_.cell_size();
    if (change > 1.25 || change < 0.8) {
      make_cells(boxes, result);
      counters_.regrids = 1;
    } else if (regrid_.outgrown(objects)) {
      regrid_.fitted(result.met, objects);
    } else {
      regrid_.resign();
    }
  }
  levels_.make_room(objects_.widest());
}

template <class Scalar, int Dim>
void EngineCore<Scalar, Dim>::start_family(double cell_size, const std::array<double, Dim>& origin,
                                           const std::vector<BoxType>& boxes) {
  levels_.start_family(cell_size, origin, config_.cell, grid_shards());
  levels_.make_room(objects_.widest());
  for (const BoxType& box : boxes) static_cast<void>(levels_.home(LevelsType::width(box)));  // asks for its level
  levels_.make_room(objects_.widest());
  counters_.regrids = 1;
}

}  // namespace sweepgrid
