#include "engine_program.hpp"

namespace sweepgrid::fuzz {

template class EngineProgram<std::int32_t, 2>;
template class EngineProgram<std::int32_t, 3>;
template class EngineProgram<std::int16_t, 2>;
template class EngineProgram<std::int16_t, 3>;

}  // namespace sweepgrid::fuzz
