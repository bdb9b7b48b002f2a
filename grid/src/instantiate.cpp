#include <sweepgrid/grid/grid_fit.inl.hpp>
#include <sweepgrid/grid/levels.inl.hpp>

namespace sweepgrid {

template class Levels<float, 2>;
template class Levels<float, 3>;
template class Levels<double, 2>;
template class Levels<double, 3>;

template struct GridFit<float, 2>;
template struct GridFit<float, 3>;
template struct GridFit<double, 2>;
template struct GridFit<double, 3>;

}  // namespace sweepgrid
