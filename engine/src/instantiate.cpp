#include <sweepgrid/engine/engine_core.inl.hpp>

namespace sweepgrid {

template class EngineCore<float, 2>;
template class EngineCore<float, 3>;
template class EngineCore<double, 2>;
template class EngineCore<double, 3>;

}  // namespace sweepgrid
