// The envelopes of the engine, which no planted bug concerns as yet, apart from the probes.

#include <sweepgrid/engine/envelope_filter.inl.hpp>
#include <sweepgrid/engine/envelopes.inl.hpp>

namespace sweepgrid {

template class Envelopes<float, 2>;
template class EnvelopeFilter<float, 2>;

}  // namespace sweepgrid
