#include <cstdint>

#include <sweepgrid/engine/engine_core.inl.hpp>
#include <sweepgrid/engine/envelope_filter.inl.hpp>
#include <sweepgrid/engine/envelopes.inl.hpp>

namespace sweepgrid {

#define SWEEPGRID_ENVELOPES(SCALAR, DIM) \
  template class Envelopes<SCALAR, DIM>; \
  template class EnvelopeFilter<SCALAR, DIM>;
SWEEPGRID_ENVELOPES(float, 2)
SWEEPGRID_ENVELOPES(float, 3)
SWEEPGRID_ENVELOPES(double, 2)
SWEEPGRID_ENVELOPES(double, 3)
SWEEPGRID_ENVELOPES(std::int32_t, 2)
SWEEPGRID_ENVELOPES(std::int32_t, 3)
SWEEPGRID_ENVELOPES(std::int16_t, 2)
SWEEPGRID_ENVELOPES(std::int16_t, 3)
#undef SWEEPGRID_ENVELOPES

}  // namespace sweepgrid
