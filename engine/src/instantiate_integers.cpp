#include <cstdint>

#include <sweepgrid/engine/engine_core.inl.hpp>

namespace sweepgrid {

template class EngineCore<std::int32_t, 2>;
template class EngineCore<std::int32_t, 3>;
template class EngineCore<std::int16_t, 2>;
template class EngineCore<std::int16_t, 3>;

}  // namespace sweepgrid
