// The core of the engine, apart from the probes that use it: most planted bugs concern only one of them.

#include <sweepgrid/engine/keyed_engine.inl.hpp>

namespace sweepgrid {

template class KeyedEngine<float, 2>;

}  // namespace sweepgrid
