#include <cstdint>

#include <sweepgrid/engine/keyed_engine.inl.hpp>

namespace sweepgrid {

template class KeyedEngine<std::int32_t, 2>;
template class KeyedEngine<std::int32_t, 3>;

}  // namespace sweepgrid
