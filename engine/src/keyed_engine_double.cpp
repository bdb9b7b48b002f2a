#include <sweepgrid/engine/keyed_engine.inl.hpp>

namespace sweepgrid {

template class KeyedEngine<double, 2>;
template class KeyedEngine<double, 3>;

}  // namespace sweepgrid
