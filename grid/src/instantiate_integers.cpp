#include <cstdint>

#include <sweepgrid/grid/grid_fit.inl.hpp>
#include <sweepgrid/grid/levels.inl.hpp>

namespace sweepgrid {

template class Levels<std::int32_t, 2>;
template class Levels<std::int32_t, 3>;
template class Levels<std::int16_t, 2>;
template class Levels<std::int16_t, 3>;

template struct GridFit<std::int32_t, 2>;
template struct GridFit<std::int32_t, 3>;
template struct GridFit<std::int16_t, 2>;
template struct GridFit<std::int16_t, 3>;

}  // namespace sweepgrid
