#include <sweepgrid/engine/keyed_engine.inl.hpp>

namespace sweepgrid {

template class KeyedEngine<float, 2>;
template class KeyedEngine<float, 3>;

}  // namespace sweepgrid
