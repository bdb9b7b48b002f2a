// The core of the engine, apart from the probes that use it: most planted bugs concern only one of them.

#include <sweepgrid/engine/engine_core.inl.hpp>

namespace sweepgrid {

template class EngineCore<float, 2>;
template class EnvelopeFilter<float, 2>;
template class Envelopes<float, 2>;

}  // namespace sweepgrid
