#include <sweepgrid/grid/grid.inl.hpp>
#include <sweepgrid/grid/grid_fit.inl.hpp>

namespace sweepgrid {

template class Grid<float, 2>;
template class Grid<float, 3>;
template class Grid<double, 2>;
template class Grid<double, 3>;

template struct GridFit<float, 2>;
template struct GridFit<float, 3>;
template struct GridFit<double, 2>;
template struct GridFit<double, 3>;

}  // namespace sweepgrid
